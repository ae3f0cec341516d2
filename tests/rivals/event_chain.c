/* Straight event-chain Monte Carlo (Bernard, Krauth and Wilson 2009) of hard discs, the rival of the chart of errors.

       PROGRAM COLUMNS ROWS PACKING_FRACTION SEED CHAIN EQUILIBRATION EVENTS

   Discs of diameter 1 start on a stretched hexagonal lattice of COLUMNS × ROWS in a periodic square. A chain moves one disc after the
   other along x or y, by CHAIN in all. Z = 1 + (sum of the distances of contact along the chain)/CHAIN (Michel, Kapfer and Krauth 2014).
   EVENTS contacts are measured after EQUILIBRATION; one line of JSON is printed. */

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define MOST 6 /* discs in a cell as wide as a diameter or slightly wider */

static int discs, cells;                  /* cells along a side */
static double side, width;
static double (*at)[2];                   /* positions */
static int (*cell)[2];                    /* cell of each disc */
static int *slots, *counts;               /* discs in the cells, and their numbers */
static uint64_t state;

static double processor_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

/* xorshift64*, the upper 53 bits as a number below 1. */
static double uniform(void)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (double)((state * 0x2545F4914F6CDD1DULL) >> 11) / 9007199254740992.0;
}

static int place(const int *of) { return of[1] * cells + of[0]; }

static void enter(int disc)
{
    int into = place(cell[disc]);
    if (counts[into] == MOST)
    {
        fprintf(stderr, "more than %d discs in a cell\n", MOST);
        exit(1);
    }
    slots[into * MOST + counts[into]++] = disc;
}

static void leave(int disc)
{
    int from = place(cell[disc]), slot = 0;
    while (slots[from * MOST + slot] != disc) slot++;
    slots[from * MOST + slot] = slots[from * MOST + --counts[from]];
}

/* Moves along an axis until a contact, the edge of the cell or the end of the chain. Returns the disc that is met, or -1. */
static int advance(int disc, int axis, double *left, double *contact)
{
    const int other_axis = 1 - axis;
    const double x = at[disc][axis], y = at[disc][other_axis];
    const double to_edge = (cell[disc][axis] + 1) * width - x;
    double least = *left < to_edge ? *left : to_edge;
    int met = -1;
    for (int ahead = 0; ahead <= 1; ahead++)
        for (int beside = -1; beside <= 1; beside++)
        {
            int of[2];
            double shift_x = 0, shift_y = 0;
            of[axis] = cell[disc][axis] + ahead;
            of[other_axis] = cell[disc][other_axis] + beside;
            if (of[axis] == cells) of[axis] = 0, shift_x = side;
            if (of[other_axis] == cells) of[other_axis] = 0, shift_y = side;
            if (of[other_axis] < 0) of[other_axis] = cells - 1, shift_y = -side;
            const int from = place(of);
            for (int slot = 0; slot < counts[from]; slot++)
            {
                const int other = slots[from * MOST + slot];
                const double dx = at[other][axis] + shift_x - x, dy = at[other][other_axis] + shift_y - y;
                if (other == disc || dx <= 0 || dy * dy >= 1) continue;
                const double touching = sqrt(1 - dy * dy);
                if (dx - touching < least)
                {
                    /* Discs that overlap by rounding are in contact. */
                    least = dx > touching ? dx - touching : 0;
                    met = other;
                    *contact = touching;
                }
            }
        }
    *left -= least;
    at[disc][axis] += least;
    if (met < 0 && least == to_edge)
    {
        leave(disc);
        cell[disc][axis]++;
        at[disc][axis] = cell[disc][axis] * width;
        if (cell[disc][axis] == cells) cell[disc][axis] = 0, at[disc][axis] = 0;
        enter(disc);
    }
    return met;
}

/* Moves chains until there were so many contacts; returns Z. */
static double chains(double length, unsigned long events)
{
    double contacts = 0, moved = 0;
    for (unsigned long done = 0; done < events;)
    {
        int disc = (int)(uniform() * discs), axis = uniform() < 0.5;
        double left = length;
        while (left > 0)
        {
            double contact = 0;
            const int met = advance(disc, axis, &left, &contact);
            if (met < 0) continue;
            contacts += contact;
            disc = met;
            done++;
        }
        moved += length;
    }
    return 1 + contacts / moved;
}

int main(int count, char **words)
{
    if (count != 8) return 2;
    const int columns = atoi(words[1]), rows = atoi(words[2]);
    const double fraction = atof(words[3]), length = atof(words[5]);
    state = 0x9E3779B97F4A7C15ULL * (strtoul(words[4], NULL, 10) + 1);
    discs = columns * rows;
    side = sqrt(discs * M_PI / (4 * fraction));
    cells = (int)side;
    width = side / cells;
    at = malloc(discs * sizeof *at);
    cell = malloc(discs * sizeof *cell);
    slots = malloc(MOST * cells * cells * sizeof *slots);
    counts = calloc(cells * cells, sizeof *counts);
    for (int disc = 0; disc < discs; disc++)
    {
        const int row = disc / columns;
        at[disc][0] = (disc % columns + 0.25 + 0.5 * (row % 2)) * side / columns;
        at[disc][1] = (row + 0.5) * side / rows;
        for (int axis = 0; axis < 2; axis++) cell[disc][axis] = (int)(at[disc][axis] / width);
        enter(disc);
    }
    chains(length, strtoul(words[6], NULL, 10));
    const double clock = processor_seconds();
    const unsigned long events = strtoul(words[7], NULL, 10);
    const double z = chains(length, events);
    printf("{\"discs\": %d, \"events\": %lu, \"seconds\": %.9f, \"compressibility\": %.9f}\n", discs, events,
        processor_seconds() - clock, z);
    return 0;
}
