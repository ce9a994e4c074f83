/* What the C twins of the kernels share: the memory of a PLC, big-endian and packed in bits, and a main program.
 *
 * A twin defines `AREAS` (what is compared with the memory of the PLC program) and `scan`, one pass of the program.
 *
 *     prog N          N scans
 *     prog N dump     N scans, then each area as `NAME LENGTH HEX`
 *     prog N time     N scans, then the processor time of one, in nanoseconds
 */
#ifndef PLC_H
#define PLC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

uint8_t I[256], Q[256], M[1024];

/* A part of the memory that is compared: its name as `--print` wants it, without the width: `M`, `DB1.DB`. */
struct area {
    const char *name;
    const uint8_t *bytes;
    unsigned length;
};

#define AREAS(...) \
    const struct area areas[] = {__VA_ARGS__}; \
    const unsigned area_count = sizeof areas / sizeof *areas;

extern const struct area areas[];
extern const unsigned area_count;

/* One pass of the program; `now` is the time in milliseconds when it begins. */
void scan(uint32_t now);

static inline uint16_t rd16(const uint8_t *at)
{
    uint16_t value;
    memcpy(&value, at, sizeof value);
    return __builtin_bswap16(value);
}

static inline uint32_t rd32(const uint8_t *at)
{
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return __builtin_bswap32(value);
}

static inline void wr16(uint8_t *at, uint16_t value)
{
    value = __builtin_bswap16(value);
    memcpy(at, &value, sizeof value);
}

static inline void wr32(uint8_t *at, uint32_t value)
{
    value = __builtin_bswap32(value);
    memcpy(at, &value, sizeof value);
}

static inline int16_t rdint(const uint8_t *at)
{
    return (int16_t)rd16(at);
}

static inline int32_t rddint(const uint8_t *at)
{
    return (int32_t)rd32(at);
}

static inline float rdreal(const uint8_t *at)
{
    uint32_t bits = rd32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void wrreal(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    wr32(at, bits);
}

static inline bool bit(const uint8_t *area, unsigned byte, unsigned number)
{
    return area[byte] >> number & 1;
}

static inline void put(uint8_t *area, unsigned byte, unsigned number, bool on)
{
    area[byte] = (uint8_t)((area[byte] & ~(1u << number)) | (unsigned)on << number);
}

/* The next pseudorandom number: the sequence at `seed` advances, its bits are mixed. */
static inline uint32_t next(uint8_t *seed)
{
    uint32_t value = rd32(seed) + 0x9E3779B9u;
    wr32(seed, value);
    value ^= value >> 15;
    return value ^ value << 7;
}

/* The next number of a xorshift at `seed`. */
static inline uint32_t advance(uint8_t *seed)
{
    uint32_t value = rd32(seed);
    value ^= value << 13;
    value ^= value >> 17;
    value ^= value << 5;
    wr32(seed, value);
    return value;
}

#if defined(__has_attribute)
#if __has_attribute(noipa)
#define OPAQUE __attribute__((noipa))
#endif
#endif
#ifndef OPAQUE
#define OPAQUE __attribute__((noinline))
#endif

/* The cycle of a PLC calls its program as something that it does not know. */
static OPAQUE void cycle(void (*program)(uint32_t), uint32_t now)
{
    program(now);
}

int main(int count, char **arguments)
{
    unsigned long scans = count > 1 ? strtoul(arguments[1], NULL, 10) : 1;
    const char *what = count > 2 ? arguments[2] : "";
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    for (unsigned long number = 0; number < scans; number++) {
        cycle(scan, (uint32_t)number);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    if (strcmp(what, "time") == 0) {
        double elapsed = (double)(end.tv_sec - start.tv_sec) * 1e9 + (double)(end.tv_nsec - start.tv_nsec);
        printf("%.2f\n", elapsed / (double)scans);
    }
    if (strcmp(what, "dump") == 0) {
        for (unsigned at = 0; at < area_count; at++) {
            printf("%s %u ", areas[at].name, areas[at].length);
            for (unsigned byte = 0; byte < areas[at].length; byte++) {
                printf("%02X", areas[at].bytes[byte]);
            }
            printf("\n");
        }
    }
    return 0;
}

#endif
