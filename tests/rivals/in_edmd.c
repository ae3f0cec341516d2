/* EDMD's part of the comparison: edmd.py appends it to the planar source; it prints one line of JSON.

       PROGRAM DISCS PACKING_FRACTION SEED BLOCK HORIZON EQUILIBRATION COLLISIONS

   Discs of mass and diameter 1 with kT = 1. A block of the calendar is BLOCK/N long, all of them together HORIZON. Z is averaged
   over the whole run, as ours is, and over the measurement alone. */

#include <time.h>

/* Discs on a hexagonal lattice with as few vacancies as possible, in a box that is nearly square. */
void hexagonal()
{
    double area = N * M_PI / (4 * packfrac);
    int rows = 2 * (int)ceil(sqrt(N / (2 * sqrt(3.0))));
    int columns = (N + rows - 1) / rows;
    double step = sqrt(area / (rows * columns * sqrt(0.75)));
    xsize = columns * step;
    ysize = rows * step * sqrt(0.75);
    initparticles(N);
    for (int i = 0; i < N; i++)
    {
        particle* p = particles + i;
        int row = i / columns;
        p->x = (i % columns + 0.25 + 0.5 * (row % 2)) * step;
        p->y = (row + 0.5) * step * sqrt(0.75);
        p->radius = 0.5;
        p->mass = 1;
    }
}

static double kinetic_temperature(void)
{
    double sum = 0;
    for (int i = 0; i < N; i++) sum += particles[i].vx * particles[i].vx + particles[i].vy * particles[i].vy;
    return sum / (2 * N);
}

/* Maxwell's velocities, with zero total momentum. */
void randommovement()
{
    double meanx = 0, meany = 0;
    for (int i = 0; i < N; i++)
    {
        meanx += (particles[i].vx = random_gaussian()) / N;
        meany += (particles[i].vy = random_gaussian()) / N;
    }
    for (int i = 0; i < N; i++)
    {
        particles[i].vx -= meanx;
        particles[i].vy -= meany;
    }
    double factor = 1 / sqrt(kinetic_temperature());
    for (int i = 0; i < N; i++)
    {
        particles[i].vx *= factor;
        particles[i].vy *= factor;
    }
}

static double processor_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

/* Peak memory in bytes; 0 if the system does not report it. */
static double peak_memory(void)
{
    double kilobytes = 0;
    char line[256];
    FILE* status = fopen("/proc/self/status", "r");
    while (status && fgets(line, sizeof line, status))
        if (sscanf(line, "VmHWM: %lf", &kilobytes) == 1) break;
    if (status) fclose(status);
    return 1024 * kilobytes;
}

static void collide(unsigned int more)
{
    unsigned int end = colcounter + more;
    while (colcounter < end) step();
}

int main(int count, char** words)
{
    if (count != 8) return 2;
    N = atoi(words[1]);
    packfrac = atof(words[2]);
    chosen_seed = strtoul(words[3], NULL, 10);
    eventlisttimemultiplier = atof(words[4]);
    maxscheduletime = atof(words[5]);
    init();
    collide(strtoul(words[6], NULL, 10));
    double clock = processor_seconds();
    unsigned int first = colcounter;
    double transferred = dvtot, begun = simtime;
    collide(strtoul(words[7], NULL, 10));
    double seconds = processor_seconds() - clock;
    double temperature = kinetic_temperature();
    printf("{\"particles\": %d, \"packing_fraction\": %.15g, \"collisions\": %u, \"seconds\": %.9f, ", N,
        N * M_PI / (4 * xsize * ysize), colcounter - first, seconds);
    printf("\"compressibility\": %.9f, \"temperature\": %.15g, \"peak_memory_bytes\": %.0f, ",
        1 - dvtot / (2 * N * temperature * simtime), temperature, peak_memory());
    printf("\"measured_compressibility\": %.9f}\n", 1 - (dvtot - transferred) / (2 * N * temperature * (simtime - begun)));
    return 0;
}
