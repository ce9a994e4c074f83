#include "../plc.h"

AREAS({"M", M, 64}, {"Q", Q, 8})

static inline bool rising(uint8_t *area, unsigned byte, unsigned number, bool on)
{
    bool was = bit(area, byte, number);
    put(area, byte, number, on);
    return on & !was;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t random = next(M);
    wr32(I, random);
    /* The program leaves a number of the mixing here. */
    uint32_t seed = rd32(M);
    wr32(M + 4, seed ^ seed >> 15);
    wr32(I + 4, seed);
    if (bit(I, 1, 5) & bit(M, 21, 3))
        put(Q, 0, 6, true);
    if (bit(I, 1, 6) & !bit(M, 22, 3))
        put(Q, 0, 6, false);
    put(Q, 0, 3, (bit(M, 32, 0) | bit(Q, 0, 3)) & !bit(I, 0, 2) & !bit(I, 6, 2));
    put(Q, 1, 5, (bit(M, 22, 0) | bit(Q, 1, 5)) & !bit(M, 26, 7) & !bit(Q, 6, 5));
    put(Q, 7, 4, (bit(I, 7, 4) | !bit(M, 22, 1)) & (bit(M, 33, 2) | bit(I, 2, 7)) & !bit(M, 21, 1));
    put(M, 31, 5, (bit(M, 35, 7) & bit(I, 1, 4)) | (!bit(M, 22, 0) & bit(Q, 4, 7)));
    put(M, 20, 7, bit(M, 31, 5) & bit(I, 6, 5));
    if (bit(I, 3, 4) & bit(I, 3, 6))
        put(Q, 7, 1, true);
    if (bit(M, 35, 1) & !bit(I, 7, 6))
        put(Q, 7, 1, false);
    put(M, 31, 6, rising(M, 40, 0, bit(Q, 6, 3) & !bit(I, 1, 2)));
    put(M, 30, 5, (bit(I, 0, 7) | !bit(Q, 6, 6)) & (bit(M, 32, 1) | bit(M, 32, 0)) & !bit(I, 1, 3));
    put(Q, 5, 1, bit(M, 21, 1) ^ bit(I, 2, 1) ^ !bit(I, 0, 1));
    put(M, 23, 7, (bit(I, 7, 7) | bit(M, 23, 7)) & !bit(M, 35, 4) & !bit(I, 2, 1));
    put(M, 20, 2, (bit(M, 29, 1) | !bit(Q, 4, 5)) & (bit(I, 5, 3) | bit(M, 30, 3)) & !bit(M, 26, 3));
    put(Q, 7, 3, rising(M, 40, 1, bit(I, 0, 0) & !bit(I, 7, 4)));
    put(M, 30, 3, (bit(I, 7, 0) | !bit(M, 31, 1)) & (bit(Q, 1, 6) | bit(Q, 3, 7)) & !bit(I, 6, 5));
    put(M, 32, 7, bit(Q, 1, 2) & !bit(I, 2, 0) & bit(I, 7, 2));
    put(Q, 6, 2, bit(I, 3, 0) & !bit(I, 3, 4) & bit(M, 27, 5));
    put(M, 24, 2, (bit(M, 20, 7) | bit(M, 24, 2)) & !bit(I, 0, 2) & !bit(I, 2, 7));
    put(Q, 3, 3, (bit(I, 0, 1) & bit(M, 34, 0)) | (!bit(I, 7, 5) & bit(M, 26, 4)));
    put(M, 28, 3, bit(Q, 3, 3) & bit(M, 35, 3));
    put(Q, 1, 6, bit(M, 34, 5) ^ bit(I, 3, 6) ^ !bit(I, 3, 4));
    put(Q, 6, 1, bit(M, 25, 3) ^ bit(I, 6, 6) ^ !bit(I, 6, 3));
    if (bit(M, 30, 4) & bit(M, 22, 1))
        put(M, 20, 7, true);
    if (bit(I, 1, 1) & !bit(I, 4, 0))
        put(M, 20, 7, false);
    put(M, 24, 6, rising(M, 40, 2, bit(M, 35, 5) & !bit(I, 4, 0)));
    put(Q, 4, 1, bit(I, 7, 0) & !bit(I, 6, 4) & bit(M, 24, 0));
    put(Q, 4, 4, (bit(M, 26, 4) | !bit(M, 25, 4)) & (bit(I, 0, 4) | bit(I, 0, 0)) & !bit(Q, 3, 7));
    put(M, 33, 1, (bit(Q, 7, 6) | !bit(M, 29, 3)) & (bit(I, 5, 3) | bit(Q, 2, 6)) & !bit(I, 0, 2));
    put(Q, 6, 4, bit(I, 0, 1) & !bit(Q, 6, 4) & bit(M, 27, 4));
    put(M, 30, 5, bit(M, 30, 3) & !bit(I, 4, 3) & bit(I, 2, 0));
    put(Q, 4, 1, (bit(I, 2, 6) | !bit(M, 21, 6)) & (bit(I, 4, 4) | bit(Q, 3, 1)) & !bit(M, 24, 6));
    if (bit(Q, 2, 0) & bit(Q, 6, 2))
        put(M, 29, 2, true);
    if (bit(M, 20, 3) & !bit(I, 0, 0))
        put(M, 29, 2, false);
    put(M, 20, 0, rising(M, 40, 3, bit(Q, 3, 7) & !bit(I, 0, 7)));
    put(Q, 7, 7, (bit(M, 22, 7) | !bit(Q, 4, 0)) & (bit(M, 26, 1) | bit(M, 24, 5)) & !bit(I, 4, 2));
    put(M, 35, 0, bit(I, 1, 3) & !bit(Q, 7, 4) & bit(Q, 4, 7));
    put(M, 29, 0, bit(M, 22, 7) & !bit(I, 6, 3) & bit(I, 1, 1));
    if (bit(M, 20, 2) & bit(I, 7, 7))
        put(Q, 7, 7, true);
    if (bit(M, 29, 2) & !bit(M, 31, 6))
        put(Q, 7, 7, false);
    put(M, 32, 5, bit(I, 3, 0) & !bit(Q, 4, 4) & bit(I, 1, 6));
    put(Q, 4, 0, !(bit(Q, 2, 3) & ((bit(I, 6, 5) & !bit(I, 5, 6)) | (bit(I, 6, 3) & bit(Q, 1, 0)))));
    put(M, 29, 2, rising(M, 40, 4, bit(M, 21, 2) & !bit(I, 7, 6)));
    put(M, 25, 1, bit(Q, 2, 1) ^ bit(I, 7, 3) ^ !bit(M, 30, 7));
    if (bit(I, 4, 3) & bit(I, 6, 6))
        put(Q, 3, 5, true);
    if (bit(M, 26, 6) & !bit(I, 5, 0))
        put(Q, 3, 5, false);
    put(Q, 4, 1, (bit(I, 6, 6) | !bit(Q, 7, 6)) & (bit(I, 0, 2) | bit(I, 6, 7)) & !bit(M, 35, 0));
    put(M, 34, 7, bit(I, 1, 3) & !bit(I, 2, 1) & bit(Q, 7, 1));
    put(Q, 6, 4, !(bit(Q, 1, 1) & ((bit(I, 4, 3) & !bit(M, 28, 3)) | (bit(M, 20, 0) & bit(M, 29, 7)))));
    put(M, 35, 3, !(bit(M, 27, 3) & ((bit(I, 6, 4) & !bit(I, 0, 3)) | (bit(M, 33, 1) & bit(I, 3, 6)))));
    if (bit(Q, 5, 6) & bit(I, 6, 3))
        put(Q, 0, 7, true);
    if (bit(I, 4, 1) & !bit(I, 7, 3))
        put(Q, 0, 7, false);
    put(Q, 4, 4, bit(I, 7, 2) ^ bit(I, 7, 6) ^ !bit(Q, 0, 2));
    put(Q, 6, 2, bit(M, 30, 1) & !bit(I, 2, 5) & bit(I, 2, 7));
    put(Q, 1, 0, (bit(I, 1, 5) | !bit(M, 23, 3)) & (bit(M, 31, 4) | bit(M, 22, 0)) & !bit(Q, 7, 3));
    if (bit(I, 7, 0) & bit(Q, 6, 3))
        put(M, 30, 3, true);
    if (bit(Q, 6, 0) & !bit(M, 21, 7))
        put(M, 30, 3, false);
    put(Q, 5, 5, (bit(I, 5, 0) | !bit(I, 5, 4)) & (bit(I, 0, 1) | bit(I, 3, 1)) & !bit(M, 34, 6));
    put(M, 24, 7, !(bit(M, 25, 0) & ((bit(Q, 4, 2) & !bit(M, 27, 5)) | (bit(I, 7, 5) & bit(M, 22, 3)))));
    put(Q, 6, 3, rising(M, 40, 5, bit(I, 0, 7) & !bit(M, 30, 2)));
    put(Q, 2, 3, bit(M, 34, 3) ^ bit(Q, 1, 4) ^ !bit(I, 4, 4));
    put(Q, 2, 3, (bit(I, 3, 5) | !bit(I, 6, 4)) & (bit(I, 3, 1) | bit(Q, 7, 0)) & !bit(I, 0, 7));
    put(M, 21, 5, (bit(I, 3, 1) | !bit(I, 3, 3)) & (bit(I, 5, 2) | bit(M, 28, 0)) & !bit(I, 5, 3));
    put(M, 24, 5, bit(I, 3, 4) & !bit(I, 3, 0) & bit(I, 6, 5));
    put(M, 33, 1, (bit(I, 6, 2) & bit(Q, 1, 2)) | (!bit(M, 28, 6) & bit(I, 4, 6)));
    put(M, 33, 6, bit(M, 33, 1) & bit(I, 4, 5));
    put(M, 32, 3, bit(Q, 6, 3) & !bit(I, 6, 2) & bit(M, 23, 1));
    put(Q, 1, 6, bit(M, 31, 2) & !bit(I, 5, 4) & bit(I, 2, 1));
    put(M, 21, 5, bit(M, 32, 1) & !bit(Q, 2, 3) & bit(M, 32, 3));
    put(M, 24, 1, rising(M, 40, 6, bit(I, 3, 0) & !bit(M, 21, 5)));
    put(M, 34, 7, rising(M, 40, 7, bit(I, 0, 0) & !bit(M, 35, 7)));
    if (bit(M, 21, 0) & bit(Q, 2, 1))
        put(M, 22, 5, true);
    if (bit(Q, 5, 1) & !bit(I, 6, 2))
        put(M, 22, 5, false);
    put(Q, 4, 7, (bit(I, 3, 1) | !bit(I, 4, 2)) & (bit(I, 4, 7) | bit(I, 4, 7)) & !bit(I, 4, 3));
    if (bit(I, 6, 2) & bit(Q, 4, 5))
        put(M, 26, 0, true);
    if (bit(M, 25, 4) & !bit(I, 0, 5))
        put(M, 26, 0, false);
    put(M, 28, 5, (bit(M, 31, 2) & bit(I, 5, 1)) | (!bit(M, 27, 2) & bit(M, 21, 4)));
    put(M, 30, 0, bit(M, 28, 5) & bit(M, 28, 4));
    put(Q, 4, 2, bit(M, 33, 6) & !bit(M, 31, 0) & bit(I, 7, 3));
    put(Q, 3, 5, !(bit(M, 29, 2) & ((bit(I, 5, 7) & !bit(I, 2, 0)) | (bit(I, 2, 7) & bit(I, 1, 2)))));
    put(M, 20, 4, !(bit(I, 5, 7) & ((bit(M, 35, 3) & !bit(I, 0, 0)) | (bit(I, 0, 6) & bit(I, 3, 2)))));
    put(Q, 3, 0, bit(I, 6, 3) & !bit(M, 33, 2) & bit(M, 29, 1));
    put(M, 34, 1, rising(M, 41, 0, bit(I, 3, 1) & !bit(I, 3, 0)));
    put(Q, 0, 1, !(bit(I, 4, 3) & ((bit(Q, 3, 2) & !bit(Q, 5, 3)) | (bit(M, 30, 3) & bit(M, 35, 7)))));
    put(Q, 6, 0, (bit(Q, 3, 4) & bit(I, 6, 1)) | (!bit(M, 25, 2) & bit(I, 0, 1)));
    put(M, 24, 0, bit(Q, 6, 0) & bit(I, 2, 5));
    put(Q, 0, 2, bit(Q, 1, 0) & !bit(I, 5, 3) & bit(M, 22, 6));
    put(Q, 7, 4, bit(I, 2, 1) & !bit(Q, 3, 4) & bit(I, 5, 6));
    if (bit(M, 20, 6) & bit(I, 6, 1))
        put(M, 29, 7, true);
    if (bit(I, 7, 0) & !bit(M, 26, 1))
        put(M, 29, 7, false);
    put(Q, 4, 3, rising(M, 41, 1, bit(I, 0, 5) & !bit(M, 23, 7)));
    put(Q, 2, 7, (bit(I, 1, 7) | !bit(Q, 1, 5)) & (bit(I, 1, 6) | bit(M, 22, 6)) & !bit(Q, 0, 5));
    put(M, 33, 4, (bit(M, 25, 6) | !bit(Q, 3, 7)) & (bit(I, 0, 5) | bit(M, 30, 2)) & !bit(M, 30, 2));
    put(M, 27, 4, bit(I, 5, 7) ^ bit(Q, 3, 3) ^ !bit(I, 4, 2));
    put(Q, 3, 5, (bit(I, 1, 2) | !bit(Q, 1, 3)) & (bit(M, 24, 2) | bit(I, 4, 6)) & !bit(I, 3, 1));
    put(M, 32, 3, bit(M, 21, 0) & !bit(M, 33, 3) & bit(M, 29, 7));
    put(M, 27, 6, (bit(Q, 3, 2) | !bit(Q, 1, 7)) & (bit(M, 30, 4) | bit(Q, 1, 6)) & !bit(I, 6, 2));
    put(M, 34, 7, !(bit(I, 6, 2) & ((bit(Q, 5, 0) & !bit(M, 35, 1)) | (bit(I, 4, 3) & bit(I, 3, 5)))));
    put(M, 35, 3, bit(M, 20, 5) & !bit(M, 30, 6) & bit(Q, 7, 3));
    put(M, 32, 4, bit(M, 21, 0) & !bit(I, 6, 6) & bit(Q, 5, 4));
    put(M, 25, 3, rising(M, 41, 2, bit(I, 1, 3) & !bit(M, 27, 2)));
    put(M, 25, 6, rising(M, 41, 3, bit(M, 20, 4) & !bit(I, 3, 4)));
    put(Q, 2, 5, bit(M, 31, 0) & !bit(Q, 0, 3) & bit(I, 4, 4));
    if (bit(M, 25, 1) & bit(Q, 4, 3))
        put(Q, 6, 3, true);
    if (bit(M, 26, 1) & !bit(Q, 7, 1))
        put(Q, 6, 3, false);
    put(Q, 7, 2, rising(M, 41, 4, bit(M, 21, 7) & !bit(M, 24, 7)));
    put(M, 33, 5, !(bit(M, 22, 2) & ((bit(Q, 5, 0) & !bit(I, 0, 5)) | (bit(I, 7, 7) & bit(I, 0, 3)))));
    put(Q, 1, 5, rising(M, 41, 5, bit(Q, 5, 5) & !bit(M, 26, 4)));
    put(M, 31, 4, rising(M, 41, 6, bit(I, 7, 1) & !bit(I, 3, 5)));
    put(M, 20, 1, rising(M, 41, 7, bit(I, 3, 7) & !bit(M, 21, 6)));
    put(Q, 1, 6, (bit(Q, 0, 5) | !bit(I, 4, 4)) & (bit(I, 2, 6) | bit(I, 5, 0)) & !bit(M, 21, 7));
    put(Q, 6, 1, (bit(M, 32, 7) | bit(Q, 6, 1)) & !bit(I, 0, 6) & !bit(M, 24, 7));
    put(Q, 0, 6, (bit(I, 1, 1) | !bit(I, 1, 2)) & (bit(M, 20, 4) | bit(Q, 3, 7)) & !bit(Q, 2, 0));
    if (bit(Q, 7, 7) & bit(Q, 4, 0))
        put(Q, 4, 1, true);
    if (bit(Q, 0, 0) & !bit(I, 0, 1))
        put(Q, 4, 1, false);
    put(Q, 0, 7, (bit(I, 5, 7) | bit(Q, 0, 7)) & !bit(M, 25, 2) & !bit(I, 5, 2));
    put(M, 28, 4, (bit(I, 5, 0) | bit(M, 28, 4)) & !bit(I, 4, 6) & !bit(I, 6, 6));
    if (bit(I, 0, 4) & bit(I, 2, 4))
        put(M, 33, 4, true);
    if (bit(M, 35, 5) & !bit(M, 22, 7))
        put(M, 33, 4, false);
    put(Q, 7, 6, !(bit(Q, 3, 4) & ((bit(M, 20, 6) & !bit(M, 22, 5)) | (bit(I, 3, 6) & bit(M, 28, 5)))));
    put(Q, 3, 3, bit(I, 1, 2) ^ bit(Q, 4, 5) ^ !bit(M, 31, 6));
    put(M, 22, 7, bit(I, 5, 0) & !bit(I, 4, 0) & bit(I, 0, 3));
    put(M, 28, 2, bit(I, 5, 3) & !bit(I, 6, 1) & bit(I, 0, 0));
    put(Q, 5, 4, bit(M, 27, 1) & !bit(Q, 6, 2) & bit(M, 25, 5));
    put(Q, 4, 0, bit(M, 35, 0) & !bit(I, 2, 5) & bit(I, 3, 4));
    put(M, 31, 1, !(bit(M, 32, 2) & ((bit(M, 27, 2) & !bit(Q, 0, 7)) | (bit(Q, 3, 0) & bit(I, 3, 1)))));
    put(M, 34, 2, (bit(I, 6, 0) | bit(M, 34, 2)) & !bit(Q, 1, 7) & !bit(I, 5, 3));
    put(Q, 2, 7, bit(M, 24, 4) & !bit(M, 33, 3) & bit(I, 0, 4));
    put(M, 35, 7, bit(I, 2, 0) & !bit(Q, 3, 7) & bit(I, 1, 4));
    put(M, 33, 4, bit(I, 0, 4) & !bit(I, 0, 7) & bit(M, 30, 2));
    put(M, 28, 3, bit(M, 25, 2) & !bit(I, 3, 2) & bit(I, 1, 1));
    put(Q, 3, 4, (bit(I, 1, 6) | bit(Q, 3, 4)) & !bit(Q, 0, 5) & !bit(I, 4, 7));
    put(Q, 0, 5, (bit(I, 5, 0) | !bit(I, 7, 1)) & (bit(I, 5, 3) | bit(I, 6, 0)) & !bit(I, 1, 7));
    put(Q, 0, 2, bit(I, 1, 3) ^ bit(M, 25, 2) ^ !bit(I, 4, 4));
    put(M, 34, 3, bit(I, 5, 1) & !bit(Q, 2, 0) & bit(I, 1, 7));
    put(Q, 2, 3, (bit(Q, 7, 6) | !bit(I, 0, 6)) & (bit(Q, 6, 0) | bit(M, 21, 5)) & !bit(I, 6, 3));
    if (bit(M, 21, 5) & bit(M, 24, 5))
        put(M, 32, 5, true);
    if (bit(I, 6, 0) & !bit(I, 1, 2))
        put(M, 32, 5, false);
    put(Q, 2, 3, (bit(M, 32, 7) | !bit(Q, 0, 0)) & (bit(I, 4, 4) | bit(Q, 0, 1)) & !bit(I, 1, 0));
    put(Q, 4, 0, rising(M, 42, 0, bit(I, 4, 5) & !bit(Q, 2, 1)));
    put(M, 27, 4, rising(M, 42, 1, bit(Q, 1, 4) & !bit(M, 27, 6)));
    put(M, 26, 3, (bit(M, 32, 6) | !bit(I, 5, 2)) & (bit(I, 5, 5) | bit(M, 28, 4)) & !bit(I, 4, 0));
    put(Q, 5, 1, bit(M, 21, 6) & !bit(M, 31, 1) & bit(M, 27, 2));
    put(Q, 4, 7, (bit(Q, 2, 6) & bit(I, 0, 6)) | (!bit(M, 23, 7) & bit(M, 24, 6)));
    put(M, 34, 7, bit(Q, 4, 7) & bit(I, 1, 6));
    put(M, 31, 4, !(bit(M, 32, 5) & ((bit(I, 7, 6) & !bit(M, 29, 2)) | (bit(M, 29, 2) & bit(M, 32, 3)))));
    put(M, 27, 5, bit(I, 3, 6) & !bit(I, 0, 0) & bit(I, 7, 4));
    put(M, 31, 0, bit(M, 20, 1) ^ bit(M, 27, 1) ^ !bit(M, 31, 6));
    put(M, 25, 1, bit(I, 5, 5) ^ bit(I, 4, 2) ^ !bit(I, 4, 5));
    put(Q, 2, 6, (bit(I, 1, 5) & bit(M, 21, 6)) | (!bit(I, 0, 4) & bit(Q, 0, 4)));
    put(M, 20, 3, bit(Q, 2, 6) & bit(M, 23, 0));
    put(M, 24, 4, (bit(M, 26, 6) | !bit(M, 23, 2)) & (bit(I, 1, 0) | bit(I, 1, 2)) & !bit(M, 35, 7));
    put(M, 20, 0, (bit(Q, 5, 2) | bit(M, 20, 0)) & !bit(Q, 3, 5) & !bit(I, 2, 0));
    put(M, 21, 0, (bit(I, 6, 0) | bit(M, 21, 0)) & !bit(M, 21, 3) & !bit(I, 3, 0));
    put(M, 22, 7, rising(M, 42, 2, bit(I, 6, 3) & !bit(M, 29, 6)));
    put(Q, 6, 4, (bit(M, 31, 1) | !bit(I, 6, 5)) & (bit(M, 22, 1) | bit(M, 31, 3)) & !bit(M, 26, 7));
    put(M, 33, 3, !(bit(I, 4, 0) & ((bit(I, 2, 3) & !bit(Q, 2, 1)) | (bit(I, 4, 2) & bit(M, 34, 7)))));
    put(Q, 5, 5, (bit(I, 6, 6) | !bit(Q, 3, 4)) & (bit(M, 26, 3) | bit(M, 24, 4)) & !bit(M, 34, 5));
    put(Q, 3, 6, (bit(I, 1, 1) & bit(M, 28, 6)) | (!bit(I, 2, 4) & bit(I, 6, 1)));
    put(M, 30, 3, bit(Q, 3, 6) & bit(Q, 2, 3));
    put(Q, 4, 5, bit(I, 1, 4) & !bit(I, 3, 4) & bit(I, 6, 4));
    put(Q, 5, 5, (bit(M, 20, 7) | !bit(I, 6, 5)) & (bit(Q, 1, 2) | bit(I, 1, 4)) & !bit(M, 27, 0));
    put(Q, 6, 2, rising(M, 42, 3, bit(I, 4, 2) & !bit(M, 21, 4)));
    put(M, 21, 0, bit(I, 1, 0) & !bit(I, 3, 5) & bit(Q, 1, 6));
    put(M, 34, 5, rising(M, 42, 4, bit(M, 21, 3) & !bit(M, 24, 7)));
    put(Q, 5, 5, bit(M, 22, 3) & !bit(Q, 4, 2) & bit(I, 7, 7));
    if (bit(M, 27, 5) & bit(Q, 1, 6))
        put(M, 24, 2, true);
    if (bit(I, 2, 7) & !bit(M, 26, 1))
        put(M, 24, 2, false);
    if (bit(I, 4, 4) & bit(I, 1, 4))
        put(M, 21, 3, true);
    if (bit(M, 23, 2) & !bit(I, 7, 7))
        put(M, 21, 3, false);
    put(Q, 0, 0, (bit(M, 35, 1) | !bit(Q, 5, 4)) & (bit(I, 7, 6) | bit(M, 26, 5)) & !bit(I, 5, 1));
    put(M, 22, 3, !(bit(I, 0, 0) & ((bit(M, 24, 4) & !bit(I, 2, 2)) | (bit(I, 4, 5) & bit(M, 25, 5)))));
    if (bit(M, 31, 4) & bit(I, 0, 0))
        put(Q, 2, 5, true);
    if (bit(I, 6, 0) & !bit(I, 7, 6))
        put(Q, 2, 5, false);
    put(Q, 3, 2, (bit(I, 2, 7) | bit(Q, 3, 2)) & !bit(Q, 6, 1) & !bit(I, 7, 7));
    put(M, 21, 1, (bit(M, 33, 5) | !bit(I, 7, 0)) & (bit(Q, 2, 2) | bit(M, 29, 0)) & !bit(M, 31, 3));
    put(Q, 7, 5, bit(M, 24, 6) ^ bit(M, 22, 0) ^ !bit(Q, 5, 4));
    if (bit(Q, 7, 1) & bit(I, 5, 6))
        put(Q, 3, 3, true);
    if (bit(I, 3, 7) & !bit(M, 28, 1))
        put(Q, 3, 3, false);
    put(Q, 4, 3, (bit(Q, 1, 3) & bit(M, 28, 7)) | (!bit(I, 7, 3) & bit(M, 23, 1)));
    put(M, 24, 1, bit(Q, 4, 3) & bit(M, 22, 7));
    put(Q, 6, 7, (bit(M, 25, 3) & bit(M, 35, 1)) | (!bit(I, 5, 0) & bit(M, 27, 0)));
    put(M, 26, 7, bit(Q, 6, 7) & bit(I, 0, 0));
    put(Q, 6, 2, !(bit(I, 3, 1) & ((bit(Q, 5, 2) & !bit(I, 5, 0)) | (bit(I, 1, 3) & bit(I, 5, 7)))));
    put(M, 31, 1, bit(M, 30, 1) & !bit(I, 3, 4) & bit(I, 3, 7));
    put(M, 24, 2, bit(M, 29, 6) & !bit(I, 4, 4) & bit(M, 20, 0));
    put(Q, 6, 2, bit(M, 25, 7) & !bit(M, 27, 1) & bit(I, 5, 3));
    put(M, 32, 7, bit(I, 5, 0) ^ bit(I, 7, 5) ^ !bit(I, 0, 3));
    put(M, 28, 1, rising(M, 42, 5, bit(I, 2, 0) & !bit(M, 23, 3)));
    if (bit(M, 32, 5) & bit(I, 5, 5))
        put(M, 31, 3, true);
    if (bit(M, 31, 3) & !bit(I, 5, 2))
        put(M, 31, 3, false);
    put(M, 32, 7, bit(M, 29, 2) ^ bit(M, 22, 2) ^ !bit(I, 4, 4));
    put(M, 31, 7, !(bit(Q, 6, 1) & ((bit(M, 30, 2) & !bit(I, 4, 0)) | (bit(I, 4, 3) & bit(Q, 0, 3)))));
    put(M, 26, 7, bit(M, 29, 1) & !bit(I, 3, 0) & bit(I, 0, 1));
    put(Q, 0, 5, (bit(I, 5, 5) & bit(Q, 0, 7)) | (!bit(M, 30, 2) & bit(I, 6, 0)));
    put(M, 32, 4, bit(Q, 0, 5) & bit(I, 5, 7));
    put(Q, 5, 0, bit(M, 30, 0) ^ bit(M, 30, 2) ^ !bit(I, 0, 2));
    if (bit(Q, 4, 7) & bit(I, 4, 7))
        put(Q, 3, 5, true);
    if (bit(M, 28, 5) & !bit(M, 28, 2))
        put(Q, 3, 5, false);
    put(M, 27, 2, bit(M, 22, 0) & !bit(M, 24, 1) & bit(I, 3, 2));
    if (bit(I, 5, 6) & bit(M, 26, 5))
        put(Q, 7, 7, true);
    if (bit(I, 1, 0) & !bit(I, 6, 5))
        put(Q, 7, 7, false);
    put(M, 20, 3, rising(M, 42, 6, bit(I, 0, 4) & !bit(Q, 6, 3)));
    put(Q, 4, 7, (bit(I, 4, 4) | bit(Q, 4, 7)) & !bit(I, 5, 0) & !bit(M, 27, 2));
    if (bit(M, 24, 4) & bit(Q, 0, 1))
        put(Q, 2, 7, true);
    if (bit(I, 0, 2) & !bit(I, 2, 5))
        put(Q, 2, 7, false);
    put(Q, 5, 6, rising(M, 42, 7, bit(Q, 6, 5) & !bit(I, 3, 3)));
    put(M, 23, 1, bit(I, 7, 2) & !bit(M, 33, 0) & bit(I, 3, 2));
    put(Q, 4, 1, (bit(Q, 2, 0) | !bit(I, 4, 1)) & (bit(I, 3, 0) | bit(M, 31, 4)) & !bit(I, 5, 0));
    put(M, 33, 5, bit(Q, 4, 6) ^ bit(M, 30, 6) ^ !bit(M, 24, 6));
    put(M, 27, 6, (bit(I, 1, 1) | bit(M, 27, 6)) & !bit(M, 21, 0) & !bit(M, 30, 7));
    put(M, 27, 6, bit(Q, 6, 5) ^ bit(Q, 1, 6) ^ !bit(M, 28, 5));
    put(M, 24, 3, (bit(I, 5, 3) & bit(M, 25, 5)) | (!bit(I, 2, 2) & bit(Q, 7, 2)));
    put(M, 32, 5, bit(M, 24, 3) & bit(Q, 0, 5));
    put(Q, 2, 6, rising(M, 43, 0, bit(Q, 4, 6) & !bit(I, 5, 5)));
    put(M, 25, 7, bit(M, 24, 0) & !bit(Q, 2, 5) & bit(M, 27, 5));
    put(M, 25, 0, bit(I, 4, 5) & !bit(I, 3, 4) & bit(M, 22, 7));
    put(M, 31, 6, bit(I, 4, 6) & !bit(M, 28, 5) & bit(I, 6, 2));
    put(Q, 6, 7, bit(M, 33, 7) & !bit(Q, 0, 1) & bit(M, 34, 7));
    put(M, 24, 7, bit(M, 20, 3) ^ bit(Q, 3, 6) ^ !bit(M, 21, 4));
    put(Q, 1, 0, (bit(M, 22, 3) | !bit(M, 34, 0)) & (bit(Q, 3, 5) | bit(M, 21, 6)) & !bit(M, 24, 6));
    put(Q, 5, 5, bit(I, 0, 2) & !bit(M, 28, 4) & bit(I, 5, 6));
    put(M, 32, 3, !(bit(M, 28, 4) & ((bit(I, 2, 0) & !bit(I, 5, 7)) | (bit(Q, 7, 2) & bit(I, 5, 3)))));
    put(Q, 0, 5, bit(M, 22, 6) ^ bit(M, 30, 0) ^ !bit(I, 3, 7));
    put(Q, 0, 3, bit(I, 6, 1) ^ bit(I, 2, 1) ^ !bit(M, 35, 2));
    put(Q, 3, 2, (bit(M, 23, 7) & bit(I, 3, 1)) | (!bit(I, 6, 3) & bit(Q, 4, 7)));
    put(M, 21, 2, bit(Q, 3, 2) & bit(Q, 6, 2));
    put(Q, 4, 7, bit(I, 5, 2) & !bit(I, 4, 5) & bit(M, 26, 2));
    put(M, 22, 3, (bit(I, 7, 2) | !bit(Q, 2, 6)) & (bit(I, 6, 1) | bit(I, 5, 1)) & !bit(Q, 3, 1));
    put(M, 20, 5, !(bit(M, 22, 3) & ((bit(M, 28, 4) & !bit(M, 22, 3)) | (bit(I, 7, 4) & bit(I, 4, 0)))));
    put(Q, 5, 0, (bit(I, 2, 4) | bit(Q, 5, 0)) & !bit(I, 2, 5) & !bit(I, 7, 7));
    put(M, 23, 1, bit(I, 6, 7) & !bit(I, 0, 0) & bit(M, 23, 6));
    if (bit(Q, 1, 5) & bit(I, 7, 4))
        put(Q, 2, 5, true);
    if (bit(I, 4, 1) & !bit(I, 3, 1))
        put(Q, 2, 5, false);
    put(Q, 7, 5, (bit(I, 2, 0) & bit(M, 28, 5)) | (!bit(I, 4, 6) & bit(M, 26, 2)));
    put(M, 20, 1, bit(Q, 7, 5) & bit(I, 3, 1));
    put(M, 27, 3, bit(I, 2, 2) & !bit(I, 0, 6) & bit(M, 23, 4));
    put(Q, 1, 3, (bit(M, 30, 1) | !bit(I, 3, 2)) & (bit(I, 5, 1) | bit(M, 25, 0)) & !bit(I, 6, 6));
}
