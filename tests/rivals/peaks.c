// Peaks of a processor for a roofline, on one thread, as JSON: clock rate, floating-point rate, and bandwidth by footprint.
// Build: cc -O2 -march=native -ffp-contract=off peaks.c -o peaks
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if defined(__AVX512F__)
#define BYTES 64
#elif defined(__AVX__)
#define BYTES 32
#else
#define BYTES 16
#endif
#define LANES (BYTES / 8)
// Independent chains: more than the latency of an operation times the units that execute it, fewer than the registers.
#define CHAINS 6
#define REPEATS 7

typedef double vector __attribute__((vector_size(BYTES)));

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static int rising(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

// Median rate of a loop: work a second.
static double rate(double (*loop)(long), long rounds) {
    double rates[REPEATS];
    for (int at = 0; at < REPEATS; at++) {
        double start = seconds();
        double work = loop(rounds);
        rates[at] = work / (seconds() - start);
    }
    qsort(rates, REPEATS, sizeof *rates, rising);
    return rates[REPEATS / 2];
}

// Clock periods of a chain of products of integers; each takes three on processors with AVX.
static double periods(long rounds) {
    long x = rounds | 1;
    for (long at = 0; at < rounds; at++)
        __asm__ volatile("imul %0, %0\nimul %0, %0\nimul %0, %0\nimul %0, %0\nimul %0, %0\n"
                         "imul %0, %0\nimul %0, %0\nimul %0, %0\nimul %0, %0\nimul %0, %0\n" : "+r"(x));
    return 30.0 * rounds;
}

// Floating-point operations of independent chains of sums and of products, as many of each.
static double separate(long rounds) {
    vector one = {0}, factor = one + 1.0000001;
    vector s0 = one, s1 = one, s2 = one, s3 = one, s4 = one, s5 = one;
    vector p0 = factor, p1 = factor, p2 = factor, p3 = factor, p4 = factor, p5 = factor;
#define STEP(s, p) s += factor, p *= factor; __asm__ volatile("" : "+x"(s), "+x"(p))
    for (long round = 0; round < rounds; round++) {
        STEP(s0, p0); STEP(s1, p1); STEP(s2, p2); STEP(s3, p3); STEP(s4, p4); STEP(s5, p5);
    }
    return 2.0 * CHAINS * LANES * rounds;
}

#if defined(__FMA__)
// Floating-point operations of independent chains of fused products and sums, two each.
static double fused(long rounds) {
    vector one = {0}, factor = one + 1.0000001;
    vector s0 = one, s1 = one, s2 = one, s3 = one, s4 = one, s5 = one, s6 = one, s7 = one, s8 = one, s9 = one, sa = one, sb = one;
#define FUSE(s) __asm__ volatile("vfmadd231pd %1, %1, %0" : "+x"(s) : "x"(factor))
    for (long round = 0; round < rounds; round++) {
        FUSE(s0); FUSE(s1); FUSE(s2); FUSE(s3); FUSE(s4); FUSE(s5);
        FUSE(s6); FUSE(s7); FUSE(s8); FUSE(s9); FUSE(sa); FUSE(sb);
    }
    return 2.0 * 2.0 * CHAINS * LANES * rounds;
}
#endif

static double *a, *b, *c;
static long length;

// Bytes of sums of two arrays into a third, of `length` numbers each.
static double moved(long rounds) {
    for (long round = 0; round < rounds; round++) {
        for (long at = 0; at < length; at += LANES) {
            vector sum = *(vector *)(b + at) + *(vector *)(c + at);
            *(vector *)(a + at) = sum;
        }
        __asm__ volatile("" ::: "memory");
    }
    return 24.0 * length * rounds;
}

int main(void) {
    static const long footprints[] = {24L << 10, 384L << 10, 6L << 20, 384L << 20};
    static const char *names[] = {"first-level cache", "second-level cache", "third-level cache", "memory"};
    printf("{\"ghz\": %.4f, \"bits\": %d", 1e-9 * rate(periods, 1000000), 8 * BYTES);
    printf(", \"separate_gflops\": %.3f", 1e-9 * rate(separate, 4000000));
#if defined(__FMA__)
    printf(", \"fused_gflops\": %.3f", 1e-9 * rate(fused, 4000000));
#endif
    printf(", \"levels\": [");
    for (int at = 0; at < 4; at++) {
        length = footprints[at] / 24 / LANES * LANES;
        double **arrays[] = {&a, &b, &c};
        for (int which = 0; which < 3; which++) {
            *arrays[which] = aligned_alloc(4096, (8 * length + 4095) / 4096 * 4096);
            if (!*arrays[which]) return 1;
            memset(*arrays[which], 0, 8 * length);
        }
        long rounds = (1L << 31) / footprints[at] + 1;
        moved(rounds / 8 + 1);
        printf("%s{\"name\": \"%s\", \"footprint\": %ld, \"gb_s\": %.2f}", at ? ", " : "", names[at], footprints[at], 1e-9 * rate(moved, rounds));
        for (int which = 0; which < 3; which++) free(*arrays[which]);
    }
    printf("]}\n");
    return 0;
}
