#include "../plc.h"

AREAS({"M", M, 64}, {"Q", Q, 8})

static inline bool rising(unsigned byte, unsigned number, bool on)
{
    bool was = bit(M, byte, number);
    put(M, byte, number, on);
    return on & !was;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 1640531527u;
    wr32(M, seed);
    wr32(I, seed ^ seed >> 15);
    if (bit(I, 3, 6) & bit(M, 24, 7))
        put(Q, 6, 1, true);
    if (bit(Q, 6, 7) & !bit(M, 33, 6))
        put(Q, 6, 1, false);
    put(M, 25, 5, (bit(I, 3, 7) & (bit(M, 25, 3) | !bit(I, 1, 7))) | (bit(I, 3, 3) & bit(I, 0, 5)));
    if (bit(I, 0, 2) & bit(M, 23, 1))
        put(M, 23, 7, true);
    if (bit(Q, 7, 5) & !bit(M, 35, 4))
        put(M, 23, 7, false);
    put(Q, 1, 5, rising(40, 0, bit(M, 31, 3) & !bit(I, 2, 1)));
    put(M, 30, 3, (bit(I, 0, 1) & (bit(I, 2, 1) | !bit(Q, 3, 3))) | (bit(M, 28, 1) & bit(I, 2, 2)));
    put(Q, 0, 5, (bit(Q, 0, 6) | !bit(I, 1, 7)) & !bit(I, 1, 6));
    put(M, 29, 6, bit(M, 21, 3) & !bit(I, 0, 3) & bit(I, 2, 7));
    if (bit(M, 26, 2) & !bit(I, 1, 0))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 10));
    put(Q, 0, 4, (rdint(M + 54) > 4000) & bit(Q, 3, 7));
    put(M, 20, 5, (rdint(M + 50) > 4500) & bit(Q, 5, 2));
    put(M, 23, 6, bit(I, 3, 3) & !bit(Q, 6, 3) & bit(M, 22, 7));
    if (bit(I, 0, 2) & !bit(M, 26, 0))
        wr16(M + 56, (uint16_t)(rdint(M + 56) + 5));
    put(Q, 2, 2, bit(Q, 5, 6) & !bit(Q, 5, 6) & bit(M, 20, 6));
    put(M, 32, 2, rising(40, 1, bit(M, 31, 6) & !bit(M, 31, 7)));
    put(M, 26, 0, (bit(M, 28, 7) | !bit(I, 0, 3)) & !bit(I, 0, 4));
    put(M, 27, 0, (rdint(M + 58) > 7500) & bit(Q, 3, 3));
    if (bit(M, 27, 3) & bit(I, 1, 2))
        put(M, 33, 4, true);
    if (bit(Q, 3, 4) & !bit(I, 3, 0))
        put(M, 33, 4, false);
    if (bit(I, 1, 7) & !bit(I, 0, 6))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 11));
    put(M, 22, 0, (bit(Q, 4, 6) | !bit(I, 0, 0)) & !bit(I, 2, 5));
    if (bit(I, 3, 4) & bit(M, 24, 4))
        put(Q, 7, 6, true);
    if (bit(I, 0, 3) & !bit(M, 23, 2))
        put(Q, 7, 6, false);
    put(M, 21, 6, bit(M, 31, 3) & !bit(I, 3, 7) & bit(I, 0, 4));
    put(Q, 5, 6, (bit(I, 2, 6) & (bit(M, 27, 4) | !bit(Q, 1, 6))) | (bit(I, 1, 5) & bit(I, 0, 1)));
    put(M, 20, 0, bit(M, 25, 3) & !bit(I, 3, 5) & bit(M, 23, 6));
    if (bit(M, 30, 2) & bit(M, 33, 1))
        put(M, 25, 1, true);
    if (bit(I, 0, 3) & !bit(M, 23, 1))
        put(M, 25, 1, false);
    put(M, 29, 1, (rdint(M + 50) > 12000) & bit(Q, 0, 5));
    put(Q, 6, 0, bit(I, 3, 5) & !bit(Q, 3, 2) & bit(I, 2, 3));
    put(Q, 5, 5, (bit(M, 24, 7) & (bit(Q, 1, 7) | !bit(I, 1, 4))) | (bit(I, 0, 1) & bit(Q, 1, 2)));
    put(Q, 3, 3, bit(I, 2, 1) & !bit(M, 31, 6) & bit(I, 1, 4));
    put(Q, 7, 4, (rdint(M + 52) > 14000) & bit(M, 24, 2));
    put(M, 30, 1, (rdint(M + 54) > 14500) & bit(M, 22, 7));
    if (bit(M, 31, 4) & !bit(M, 31, 3))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 6));
    put(Q, 4, 0, (bit(I, 2, 2) & (bit(Q, 6, 2) | !bit(I, 2, 0))) | (bit(Q, 6, 0) & bit(I, 0, 0)));
    put(Q, 2, 0, rising(40, 2, bit(I, 1, 1) & !bit(M, 25, 4)));
    put(Q, 4, 3, rising(40, 3, bit(M, 25, 5) & !bit(Q, 7, 3)));
    put(M, 32, 4, (rdint(M + 58) > 17000) & bit(M, 26, 5));
    put(M, 31, 7, (bit(I, 1, 3) & (bit(I, 3, 6) | !bit(Q, 4, 5))) | (bit(I, 1, 3) & bit(I, 3, 0)));
    put(M, 29, 2, rising(40, 4, bit(I, 3, 2) & !bit(M, 21, 7)));
    put(M, 29, 0, (bit(I, 3, 6) & (bit(M, 21, 6) | !bit(Q, 5, 5))) | (bit(M, 30, 6) & bit(I, 3, 6)));
    if (bit(I, 0, 0) & !bit(I, 1, 5))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 5));
    put(Q, 2, 4, (bit(Q, 7, 0) | !bit(I, 3, 1)) & !bit(M, 29, 1));
    put(Q, 1, 7, (rdint(M + 52) > 0) & bit(M, 21, 5));
    put(M, 26, 3, (bit(M, 28, 5) & (bit(M, 27, 1) | !bit(I, 0, 2))) | (bit(M, 26, 0) & bit(Q, 2, 0)));
    if (bit(I, 0, 2) & !bit(I, 1, 7))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 9));
    put(Q, 7, 5, (rdint(M + 54) > 1500) & bit(I, 0, 7));
    if (bit(I, 2, 3) & bit(M, 20, 1))
        put(M, 33, 2, true);
    if (bit(I, 1, 2) & !bit(I, 2, 6))
        put(M, 33, 2, false);
    put(M, 35, 2, (rdint(M + 54) > 2500) & bit(Q, 0, 6));
    put(Q, 4, 6, (bit(I, 2, 2) & (bit(M, 32, 0) | !bit(I, 1, 0))) | (bit(Q, 6, 3) & bit(M, 34, 1)));
    put(M, 28, 1, (bit(M, 23, 1) | !bit(M, 34, 3)) & !bit(Q, 6, 3));
    if (bit(I, 2, 5) & bit(I, 1, 6))
        put(Q, 6, 2, true);
    if (bit(I, 0, 2) & !bit(Q, 4, 5))
        put(Q, 6, 2, false);
    put(M, 23, 5, bit(M, 29, 2) & !bit(I, 3, 1) & bit(M, 30, 0));
    put(M, 31, 0, (bit(M, 22, 5) | !bit(I, 3, 0)) & !bit(I, 3, 1));
    put(M, 33, 7, rising(40, 5, bit(M, 33, 2) & !bit(I, 3, 0)));
    if (bit(I, 2, 1) & !bit(Q, 1, 1))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 10));
    put(Q, 4, 4, rising(40, 6, bit(I, 3, 0) & !bit(I, 0, 1)));
    put(Q, 0, 0, bit(I, 3, 3) & !bit(Q, 4, 4) & bit(M, 31, 2));
    put(Q, 4, 7, (bit(I, 2, 0) | !bit(M, 30, 5)) & !bit(I, 0, 4));
    put(M, 27, 6, (bit(I, 2, 5) | !bit(M, 26, 0)) & !bit(I, 2, 4));
    put(Q, 0, 2, (bit(Q, 7, 7) & (bit(I, 1, 2) | !bit(Q, 7, 3))) | (bit(M, 34, 7) & bit(I, 2, 1)));
    if (bit(M, 31, 2) & !bit(M, 35, 5))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 7));
    if (bit(M, 33, 1) & !bit(I, 2, 4))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 8));
    put(M, 30, 2, (rdint(M + 56) > 10000) & bit(M, 33, 1));
    put(Q, 1, 4, (bit(I, 0, 6) | !bit(Q, 2, 2)) & !bit(Q, 6, 4));
    put(M, 34, 1, bit(I, 0, 3) & !bit(Q, 4, 0) & bit(M, 27, 1));
    put(M, 25, 6, rising(40, 7, bit(I, 2, 7) & !bit(M, 27, 6)));
    put(Q, 3, 0, bit(M, 22, 1) & !bit(M, 23, 4) & bit(M, 33, 4));
    if (bit(I, 1, 6) & bit(I, 1, 2))
        put(M, 28, 5, true);
    if (bit(Q, 4, 5) & !bit(I, 1, 6))
        put(M, 28, 5, false);
    put(M, 23, 4, (rdint(M + 54) > 13000) & bit(M, 28, 1));
    put(M, 20, 3, (rdint(M + 52) > 13500) & bit(I, 2, 4));
    if (bit(I, 1, 7) & !bit(I, 0, 6))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 8));
    if (bit(I, 2, 7) & bit(I, 0, 5))
        put(M, 25, 3, true);
    if (bit(M, 22, 1) & !bit(Q, 5, 4))
        put(M, 25, 3, false);
    put(M, 28, 0, (bit(I, 1, 5) | !bit(M, 21, 6)) & !bit(M, 26, 0));
    if (bit(I, 0, 6) & !bit(Q, 5, 2))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 11));
    if (bit(Q, 0, 6) & !bit(M, 20, 6))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 3));
    if (bit(M, 33, 4) & !bit(M, 33, 5))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 4));
    put(M, 33, 3, (bit(I, 3, 5) | !bit(I, 2, 3)) & !bit(M, 25, 4));
    put(M, 26, 7, (bit(Q, 5, 0) & (bit(M, 23, 1) | !bit(I, 1, 0))) | (bit(Q, 1, 3) & bit(I, 2, 3)));
    put(M, 31, 1, rising(41, 0, bit(M, 22, 6) & !bit(M, 32, 7)));
    if (bit(M, 32, 4) & bit(Q, 7, 5))
        put(M, 21, 0, true);
    if (bit(M, 26, 1) & !bit(M, 23, 4))
        put(M, 21, 0, false);
    put(Q, 3, 6, bit(M, 32, 4) & !bit(Q, 6, 3) & bit(I, 3, 6));
    put(M, 20, 6, rising(41, 1, bit(I, 1, 2) & !bit(I, 1, 7)));
    put(Q, 6, 6, rising(41, 2, bit(Q, 4, 2) & !bit(I, 2, 3)));
    put(Q, 6, 4, (rdint(M + 56) > 500) & bit(M, 32, 7));
    if (bit(I, 1, 2) & !bit(I, 1, 2))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 4));
    if (bit(Q, 5, 4) & bit(M, 27, 1))
        put(M, 24, 3, true);
    if (bit(I, 0, 1) & !bit(M, 23, 0))
        put(M, 24, 3, false);
    put(Q, 2, 6, rising(41, 3, bit(Q, 2, 7) & !bit(M, 27, 7)));
    if (bit(I, 1, 7) & bit(M, 29, 1))
        put(Q, 7, 0, true);
    if (bit(I, 3, 0) & !bit(Q, 7, 4))
        put(Q, 7, 0, false);
    put(M, 30, 7, rising(41, 4, bit(M, 35, 6) & !bit(M, 33, 4)));
    put(M, 26, 5, bit(M, 30, 7) & !bit(Q, 7, 1) & bit(I, 0, 2));
    put(M, 35, 1, bit(M, 33, 1) & !bit(I, 2, 1) & bit(Q, 4, 6));
    put(M, 25, 4, (bit(M, 33, 2) | !bit(M, 33, 3)) & !bit(I, 0, 1));
    put(M, 35, 6, (bit(Q, 0, 4) | !bit(M, 33, 4)) & !bit(M, 25, 4));
    if (bit(I, 1, 5) & bit(M, 35, 0))
        put(M, 21, 5, true);
    if (bit(M, 26, 3) & !bit(Q, 6, 1))
        put(M, 21, 5, false);
    put(M, 31, 3, rising(41, 5, bit(I, 0, 5) & !bit(Q, 5, 4)));
    put(Q, 5, 3, bit(I, 3, 4) & !bit(Q, 4, 7) & bit(M, 22, 7));
    put(M, 28, 4, (bit(I, 0, 4) & (bit(M, 21, 5) | !bit(M, 26, 2))) | (bit(M, 20, 3) & bit(I, 3, 6)));
    put(Q, 3, 2, bit(M, 33, 3) & !bit(M, 24, 5) & bit(I, 1, 2));
    if (bit(M, 21, 7) & !bit(M, 31, 5))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 9));
    put(Q, 2, 7, (bit(M, 23, 6) & (bit(M, 35, 6) | !bit(Q, 5, 2))) | (bit(M, 34, 2) & bit(Q, 6, 1)));
    put(Q, 5, 2, rising(41, 6, bit(I, 1, 4) & !bit(I, 2, 5)));
    if (bit(I, 1, 6) & !bit(Q, 3, 7))
        wr16(M + 60, (uint16_t)(rdint(M + 60) + 3));
    put(M, 35, 0, (bit(I, 1, 0) | !bit(M, 30, 0)) & !bit(M, 27, 3));
    put(M, 33, 1, (bit(M, 24, 4) & (bit(I, 2, 5) | !bit(M, 24, 2))) | (bit(M, 24, 4) & bit(I, 1, 3)));
    put(M, 34, 6, bit(M, 33, 4) & !bit(M, 28, 3) & bit(I, 1, 6));
    put(M, 23, 2, bit(M, 28, 5) & !bit(M, 21, 4) & bit(M, 28, 6));
    put(M, 21, 2, (bit(M, 29, 2) & (bit(M, 26, 3) | !bit(M, 32, 0))) | (bit(M, 29, 4) & bit(M, 26, 2)));
    put(M, 22, 3, bit(I, 0, 1) & !bit(M, 20, 1) & bit(I, 0, 0));
    put(M, 35, 4, rising(41, 7, bit(I, 2, 4) & !bit(I, 3, 5)));
    if (bit(I, 1, 6) & bit(I, 2, 1))
        put(M, 21, 1, true);
    if (bit(I, 2, 2) & !bit(I, 3, 7))
        put(M, 21, 1, false);
    if (bit(M, 31, 3) & !bit(I, 2, 4))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 3));
    put(M, 30, 4, bit(M, 29, 6) & !bit(I, 0, 1) & bit(I, 0, 2));
    put(M, 23, 3, rising(42, 0, bit(M, 26, 5) & !bit(Q, 0, 5)));
    put(M, 28, 6, (bit(M, 35, 6) | !bit(M, 22, 1)) & !bit(I, 0, 1));
    if (bit(I, 3, 2) & !bit(M, 31, 5))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 7));
    put(M, 25, 2, (bit(I, 0, 7) & (bit(Q, 4, 7) | !bit(I, 1, 3))) | (bit(M, 22, 3) & bit(M, 29, 1)));
    if (bit(I, 3, 3) & bit(Q, 7, 2))
        put(M, 33, 5, true);
    if (bit(Q, 2, 3) & !bit(M, 27, 7))
        put(M, 33, 5, false);
    put(Q, 7, 2, rising(42, 1, bit(I, 3, 7) & !bit(M, 35, 3)));
    put(M, 27, 5, (bit(Q, 6, 7) | !bit(I, 1, 7)) & !bit(I, 3, 7));
    put(M, 20, 2, (bit(M, 24, 2) & (bit(Q, 4, 1) | !bit(I, 1, 0))) | (bit(M, 22, 2) & bit(M, 27, 6)));
    put(M, 28, 7, rising(42, 2, bit(I, 2, 3) & !bit(Q, 6, 0)));
    put(M, 27, 2, bit(M, 34, 4) & !bit(M, 23, 7) & bit(M, 26, 0));
    put(M, 26, 4, (bit(I, 2, 1) & (bit(I, 0, 4) | !bit(Q, 5, 2))) | (bit(I, 0, 6) & bit(Q, 3, 7)));
    put(M, 34, 2, (bit(I, 3, 3) & (bit(M, 29, 3) | !bit(Q, 4, 2))) | (bit(I, 3, 3) & bit(M, 25, 3)));
    put(M, 20, 1, (bit(I, 0, 7) | !bit(Q, 1, 4)) & !bit(I, 3, 2));
    put(M, 34, 7, (bit(M, 23, 7) & (bit(I, 2, 3) | !bit(Q, 0, 3))) | (bit(I, 1, 7) & bit(M, 30, 3)));
    if (bit(M, 25, 1) & bit(Q, 0, 2))
        put(M, 28, 2, true);
    if (bit(Q, 7, 0) & !bit(I, 0, 0))
        put(M, 28, 2, false);
    if (bit(Q, 7, 0) & bit(I, 1, 2))
        put(Q, 4, 2, true);
    if (bit(I, 1, 5) & !bit(Q, 6, 7))
        put(Q, 4, 2, false);
    put(Q, 6, 3, (bit(Q, 0, 5) | !bit(I, 0, 7)) & !bit(Q, 2, 7));
    if (bit(I, 3, 7) & !bit(M, 22, 5))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 4));
    put(Q, 5, 7, bit(Q, 6, 1) & !bit(I, 2, 4) & bit(I, 1, 5));
    put(Q, 6, 5, (bit(M, 35, 6) & (bit(I, 3, 5) | !bit(M, 29, 0))) | (bit(Q, 2, 7) & bit(I, 2, 3)));
    if (bit(I, 3, 3) & bit(M, 29, 0))
        put(Q, 7, 7, true);
    if (bit(Q, 3, 5) & !bit(I, 1, 6))
        put(Q, 7, 7, false);
    put(M, 22, 4, rising(42, 3, bit(Q, 3, 4) & !bit(Q, 2, 2)));
    if (bit(M, 30, 1) & !bit(M, 32, 5))
        wr16(M + 60, (uint16_t)(rdint(M + 60) + 9));
    put(M, 21, 7, (bit(I, 2, 7) | !bit(M, 23, 3)) & !bit(M, 31, 4));
    if (bit(I, 2, 1) & bit(M, 20, 1))
        put(M, 22, 1, true);
    if (bit(I, 0, 0) & !bit(I, 1, 6))
        put(M, 22, 1, false);
    if (bit(M, 33, 0) & !bit(I, 0, 6))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 3));
    put(M, 32, 0, bit(Q, 4, 1) & !bit(M, 26, 6) & bit(I, 0, 4));
    put(M, 32, 7, (bit(I, 2, 4) | !bit(I, 0, 4)) & !bit(M, 26, 6));
    put(Q, 1, 1, rising(42, 4, bit(M, 33, 3) & !bit(M, 29, 2)));
    if (bit(M, 24, 3) & bit(Q, 7, 0))
        put(M, 33, 6, true);
    if (bit(I, 1, 0) & !bit(I, 3, 7))
        put(M, 33, 6, false);
    put(M, 22, 5, (rdint(M + 60) > 10000) & bit(M, 20, 2));
    if (bit(I, 3, 2) & bit(M, 24, 7))
        put(Q, 7, 3, true);
    if (bit(Q, 7, 2) & !bit(I, 0, 3))
        put(Q, 7, 3, false);
    if (bit(M, 21, 4) & !bit(I, 2, 7))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 10));
    if (bit(I, 3, 3) & bit(I, 0, 0))
        put(M, 31, 5, true);
    if (bit(I, 2, 2) & !bit(I, 2, 7))
        put(M, 31, 5, false);
    put(M, 25, 7, (rdint(M + 52) > 12000) & bit(Q, 1, 7));
    put(Q, 1, 0, (bit(I, 3, 7) & (bit(I, 2, 5) | !bit(M, 22, 1))) | (bit(M, 24, 0) & bit(I, 2, 7)));
    put(M, 27, 4, (rdint(M + 54) > 13000) & bit(Q, 2, 4));
    put(Q, 7, 1, (bit(I, 1, 4) & (bit(I, 2, 5) | !bit(Q, 3, 0))) | (bit(I, 1, 6) & bit(Q, 0, 4)));
    put(M, 35, 5, rising(42, 5, bit(M, 21, 5) & !bit(M, 29, 0)));
    put(Q, 1, 3, (bit(I, 0, 0) | !bit(M, 24, 0)) & !bit(I, 2, 6));
}
