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
    put(M, 20, 5, rising(40, 0, bit(M, 27, 2) & !bit(I, 2, 0)));
    put(M, 24, 4, (bit(M, 27, 2) & (bit(M, 29, 4) | !bit(I, 3, 7))) | (bit(I, 1, 4) & bit(M, 24, 1)));
    put(M, 29, 2, (rdint(M + 56) > 1000) & bit(I, 3, 1));
    put(M, 34, 5, (bit(Q, 1, 5) | !bit(Q, 2, 2)) & !bit(I, 0, 6));
    put(M, 25, 3, bit(I, 1, 5) & !bit(Q, 1, 2) & bit(M, 25, 0));
    put(M, 23, 6, (bit(Q, 5, 2) | !bit(Q, 6, 5)) & !bit(I, 3, 0));
    put(M, 23, 5, bit(I, 0, 1) & !bit(Q, 2, 2) & bit(M, 34, 4));
    put(M, 29, 0, (bit(M, 29, 7) & (bit(I, 2, 0) | !bit(M, 35, 5))) | (bit(M, 23, 3) & bit(I, 1, 1)));
    if (bit(M, 23, 3) & bit(I, 2, 5))
        put(M, 24, 6, true);
    if (bit(M, 24, 4) & !bit(I, 0, 6))
        put(M, 24, 6, false);
    put(M, 23, 7, (bit(I, 0, 1) & (bit(M, 34, 7) | !bit(M, 29, 3))) | (bit(Q, 4, 5) & bit(M, 22, 7)));
    put(Q, 0, 6, (bit(I, 0, 2) & (bit(Q, 1, 7) | !bit(I, 0, 6))) | (bit(I, 3, 7) & bit(M, 20, 6)));
    put(M, 29, 4, bit(M, 32, 7) & !bit(M, 23, 5) & bit(I, 1, 4));
    put(M, 24, 2, (bit(M, 26, 3) & (bit(I, 1, 4) | !bit(Q, 1, 4))) | (bit(I, 3, 7) & bit(Q, 5, 5)));
    if (bit(M, 24, 3) & !bit(M, 25, 3))
        wr16(M + 60, (uint16_t)(rdint(M + 60) + 7));
    if (bit(M, 21, 7) & !bit(M, 28, 0))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 8));
    put(Q, 1, 5, (bit(Q, 6, 4) | !bit(I, 2, 2)) & !bit(M, 31, 4));
    put(M, 24, 3, (rdint(M + 56) > 8000) & bit(M, 28, 4));
    put(Q, 7, 5, (rdint(M + 52) > 8500) & bit(M, 29, 5));
    put(Q, 5, 3, (rdint(M + 50) > 9000) & bit(M, 22, 1));
    if (bit(M, 21, 0) & bit(M, 24, 0))
        put(M, 28, 7, true);
    if (bit(I, 3, 6) & !bit(M, 35, 3))
        put(M, 28, 7, false);
    put(M, 30, 0, (rdint(M + 58) > 10000) & bit(Q, 1, 0));
    put(Q, 0, 3, (bit(M, 21, 2) | !bit(M, 33, 7)) & !bit(M, 21, 5));
    put(Q, 4, 5, (bit(Q, 4, 3) | !bit(I, 3, 4)) & !bit(I, 2, 3));
    put(M, 26, 3, (bit(M, 32, 7) & (bit(I, 1, 1) | !bit(Q, 0, 4))) | (bit(M, 35, 7) & bit(M, 28, 2)));
    put(M, 31, 7, rising(40, 1, bit(I, 1, 2) & !bit(M, 29, 5)));
    put(Q, 4, 1, (bit(I, 3, 2) | !bit(I, 1, 7)) & !bit(I, 1, 0));
    put(Q, 5, 0, rising(40, 2, bit(Q, 0, 6) & !bit(I, 0, 0)));
    if (bit(M, 34, 6) & bit(I, 3, 1))
        put(Q, 7, 3, true);
    if (bit(Q, 7, 5) & !bit(I, 1, 5))
        put(Q, 7, 3, false);
    put(M, 34, 6, bit(M, 23, 3) & !bit(M, 31, 1) & bit(I, 1, 2));
    put(M, 23, 2, (bit(M, 35, 5) | !bit(Q, 6, 6)) & !bit(M, 35, 5));
    put(M, 30, 7, (rdint(M + 58) > 15000) & bit(M, 32, 1));
    put(Q, 5, 4, (bit(M, 35, 5) | !bit(Q, 2, 6)) & !bit(M, 26, 7));
    if (bit(Q, 3, 5) & bit(I, 3, 7))
        put(Q, 6, 4, true);
    if (bit(M, 30, 3) & !bit(Q, 1, 7))
        put(Q, 6, 4, false);
    if (bit(I, 2, 5) & !bit(Q, 5, 2))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 9));
    put(M, 20, 2, (rdint(M + 58) > 17000) & bit(I, 0, 0));
    if (bit(M, 24, 1) & bit(Q, 6, 3))
        put(Q, 2, 4, true);
    if (bit(M, 29, 7) & !bit(M, 21, 5))
        put(Q, 2, 4, false);
    put(M, 22, 1, rising(40, 3, bit(I, 1, 3) & !bit(M, 35, 5)));
    put(Q, 3, 1, (bit(M, 26, 5) | !bit(M, 25, 0)) & !bit(I, 0, 6));
    if (bit(I, 1, 6) & !bit(M, 35, 4))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 5));
    put(Q, 0, 1, (bit(I, 1, 7) & (bit(Q, 3, 4) | !bit(I, 2, 5))) | (bit(M, 27, 4) & bit(I, 3, 2)));
    if (bit(M, 33, 3) & !bit(M, 26, 7))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 7));
    put(M, 33, 4, (bit(I, 1, 6) | !bit(M, 24, 4)) & !bit(I, 2, 6));
    put(M, 21, 2, rising(40, 4, bit(M, 29, 6) & !bit(M, 21, 7)));
    if (bit(I, 1, 3) & bit(I, 3, 0))
        put(M, 21, 4, true);
    if (bit(I, 1, 0) & !bit(M, 26, 1))
        put(M, 21, 4, false);
    put(M, 35, 2, rising(40, 5, bit(Q, 4, 3) & !bit(M, 33, 5)));
    put(M, 35, 4, (bit(M, 26, 3) | !bit(M, 32, 1)) & !bit(M, 35, 2));
    if (bit(I, 2, 6) & bit(M, 25, 4))
        put(M, 22, 0, true);
    if (bit(M, 32, 7) & !bit(I, 3, 3))
        put(M, 22, 0, false);
    if (bit(Q, 4, 7) & bit(M, 31, 6))
        put(M, 27, 7, true);
    if (bit(I, 3, 3) & !bit(I, 2, 3))
        put(M, 27, 7, false);
    put(Q, 3, 2, (bit(M, 25, 4) & (bit(Q, 5, 5) | !bit(M, 20, 4))) | (bit(M, 27, 7) & bit(M, 26, 0)));
    put(Q, 7, 6, (rdint(M + 58) > 4500) & bit(I, 1, 5));
    put(M, 33, 3, bit(I, 0, 1) & !bit(M, 32, 2) & bit(I, 0, 1));
    put(M, 29, 3, rising(40, 6, bit(M, 21, 0) & !bit(Q, 7, 3)));
    put(M, 30, 3, bit(M, 27, 2) & !bit(I, 3, 5) & bit(Q, 6, 5));
    put(M, 28, 2, (bit(M, 32, 0) & (bit(M, 22, 5) | !bit(Q, 5, 6))) | (bit(I, 2, 2) & bit(I, 1, 0)));
    if (bit(M, 29, 1) & bit(Q, 7, 0))
        put(M, 34, 0, true);
    if (bit(M, 33, 1) & !bit(I, 3, 5))
        put(M, 34, 0, false);
    put(M, 33, 0, rising(40, 7, bit(M, 24, 6) & !bit(I, 2, 3)));
    put(Q, 6, 3, (rdint(M + 58) > 8000) & bit(I, 2, 4));
    put(M, 20, 7, (bit(M, 20, 5) & (bit(M, 29, 7) | !bit(I, 2, 7))) | (bit(Q, 4, 6) & bit(I, 2, 1)));
    if (bit(M, 23, 2) & bit(Q, 5, 4))
        put(M, 30, 1, true);
    if (bit(I, 0, 3) & !bit(I, 3, 0))
        put(M, 30, 1, false);
    put(M, 27, 3, (bit(M, 26, 0) | !bit(M, 21, 7)) & !bit(M, 27, 3));
    put(M, 23, 0, (bit(Q, 5, 0) | !bit(I, 3, 5)) & !bit(M, 26, 0));
    put(Q, 0, 2, (bit(Q, 2, 5) | !bit(M, 29, 6)) & !bit(M, 20, 4));
    put(M, 28, 0, (rdint(M + 60) > 11000) & bit(I, 3, 0));
    put(Q, 1, 2, (bit(M, 22, 4) & (bit(I, 3, 3) | !bit(M, 27, 6))) | (bit(M, 35, 4) & bit(M, 29, 7)));
    if (bit(Q, 2, 7) & !bit(M, 34, 2))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 4));
    if (bit(I, 1, 6) & !bit(I, 0, 5))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 5));
    if (bit(Q, 7, 1) & !bit(M, 34, 4))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 6));
    if (bit(Q, 4, 4) & !bit(I, 3, 2))
        wr16(M + 56, (uint16_t)(rdint(M + 56) + 7));
    put(M, 29, 1, bit(M, 21, 5) & !bit(I, 1, 5) & bit(M, 23, 6));
    put(M, 31, 0, rising(41, 0, bit(I, 2, 0) & !bit(Q, 5, 4)));
    put(Q, 2, 5, bit(M, 27, 1) & !bit(M, 23, 0) & bit(M, 29, 4));
    put(M, 31, 1, rising(41, 1, bit(I, 1, 3) & !bit(I, 3, 7)));
    put(M, 21, 5, bit(Q, 7, 7) & !bit(M, 32, 4) & bit(I, 3, 6));
    put(Q, 4, 2, (bit(Q, 4, 5) & (bit(M, 27, 4) | !bit(I, 1, 6))) | (bit(Q, 0, 7) & bit(I, 3, 6)));
    put(Q, 5, 5, (bit(I, 1, 2) | !bit(I, 1, 3)) & !bit(M, 29, 6));
    put(M, 33, 6, (bit(M, 29, 6) | !bit(M, 20, 6)) & !bit(M, 28, 3));
    put(M, 23, 1, (rdint(M + 60) > 18000) & bit(I, 1, 1));
    put(Q, 0, 0, bit(I, 2, 7) & !bit(I, 2, 3) & bit(I, 3, 4));
    put(M, 20, 6, rising(41, 2, bit(I, 1, 7) & !bit(Q, 5, 7)));
    if (bit(M, 32, 2) & !bit(I, 0, 4))
        wr16(M + 60, (uint16_t)(rdint(M + 60) + 10));
    if (bit(M, 33, 6) & bit(I, 1, 5))
        put(M, 33, 5, true);
    if (bit(M, 33, 1) & !bit(M, 24, 6))
        put(M, 33, 5, false);
    put(M, 33, 7, (bit(I, 3, 4) | !bit(I, 2, 5)) & !bit(M, 25, 0));
    put(Q, 7, 2, bit(I, 3, 4) & !bit(I, 0, 5) & bit(M, 21, 0));
    put(Q, 2, 0, (bit(M, 28, 2) & (bit(I, 1, 7) | !bit(M, 21, 4))) | (bit(Q, 3, 0) & bit(M, 31, 3)));
    put(M, 26, 4, rising(41, 3, bit(I, 1, 2) & !bit(M, 30, 0)));
    put(Q, 6, 5, rising(41, 4, bit(M, 26, 7) & !bit(M, 27, 0)));
    put(M, 25, 4, bit(M, 30, 2) & !bit(I, 0, 7) & bit(M, 34, 0));
    put(M, 31, 4, bit(M, 31, 2) & !bit(I, 1, 0) & bit(Q, 3, 2));
    if (bit(I, 2, 4) & !bit(I, 1, 2))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 10));
    if (bit(M, 28, 6) & bit(M, 34, 0))
        put(Q, 6, 7, true);
    if (bit(I, 2, 7) & !bit(I, 0, 0))
        put(Q, 6, 7, false);
    if (bit(Q, 4, 1) & !bit(M, 29, 6))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 3));
    put(M, 22, 2, (rdint(M + 52) > 5500) & bit(M, 21, 5));
    put(Q, 2, 2, (bit(M, 32, 7) | !bit(I, 1, 6)) & !bit(I, 0, 1));
    if (bit(I, 0, 6) & !bit(I, 3, 2))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 6));
    put(Q, 1, 4, (rdint(M + 60) > 7000) & bit(I, 3, 2));
    put(Q, 1, 1, (bit(M, 21, 5) | !bit(M, 22, 2)) & !bit(Q, 4, 3));
    put(Q, 2, 3, (bit(I, 2, 2) | !bit(I, 2, 4)) & !bit(M, 20, 6));
    put(Q, 6, 2, (rdint(M + 52) > 8500) & bit(M, 25, 6));
    put(M, 32, 6, (rdint(M + 54) > 9000) & bit(M, 21, 3));
    put(M, 20, 0, (rdint(M + 52) > 9500) & bit(I, 2, 6));
    if (bit(I, 0, 1) & bit(Q, 4, 7))
        put(M, 25, 7, true);
    if (bit(I, 1, 3) & !bit(M, 20, 5))
        put(M, 25, 7, false);
    put(M, 32, 1, bit(M, 30, 7) & !bit(Q, 0, 2) & bit(I, 3, 4));
    put(M, 20, 4, bit(M, 26, 7) & !bit(I, 0, 3) & bit(I, 1, 7));
    put(M, 35, 6, (bit(I, 2, 5) | !bit(M, 30, 2)) & !bit(M, 24, 3));
    if (bit(I, 0, 7) & bit(M, 22, 1))
        put(M, 26, 1, true);
    if (bit(M, 25, 1) & !bit(I, 0, 0))
        put(M, 26, 1, false);
    put(M, 32, 4, rising(41, 5, bit(M, 29, 0) & !bit(M, 25, 0)));
    if (bit(Q, 1, 2) & !bit(M, 21, 0))
        wr16(M + 56, (uint16_t)(rdint(M + 56) + 10));
    put(M, 30, 5, rising(41, 6, bit(M, 27, 3) & !bit(M, 33, 6)));
    put(M, 27, 1, (rdint(M + 52) > 14000) & bit(M, 33, 6));
    if (bit(M, 22, 0) & !bit(I, 3, 5))
        wr16(M + 50, (uint16_t)(rdint(M + 50) + 4));
    if (bit(I, 1, 1) & !bit(I, 3, 4))
        wr16(M + 52, (uint16_t)(rdint(M + 52) + 5));
    if (bit(M, 31, 5) & bit(M, 21, 1))
        put(M, 23, 3, true);
    if (bit(M, 34, 4) & !bit(I, 0, 5))
        put(M, 23, 3, false);
    put(M, 34, 7, rising(41, 7, bit(I, 2, 1) & !bit(I, 1, 7)));
    if (bit(M, 31, 7) & bit(I, 1, 3))
        put(M, 28, 6, true);
    if (bit(I, 3, 0) & !bit(Q, 5, 7))
        put(M, 28, 6, false);
    if (bit(Q, 5, 3) & bit(I, 1, 6))
        put(Q, 4, 3, true);
    if (bit(M, 31, 4) & !bit(I, 3, 7))
        put(Q, 4, 3, false);
    put(M, 27, 5, bit(Q, 0, 7) & !bit(Q, 7, 1) & bit(M, 24, 6));
    put(M, 28, 3, (rdint(M + 58) > 18000) & bit(I, 3, 1));
    put(M, 33, 2, bit(M, 20, 1) & !bit(I, 0, 2) & bit(I, 0, 6));
    put(M, 33, 1, rising(42, 0, bit(I, 0, 5) & !bit(I, 1, 0)));
    put(Q, 5, 6, rising(42, 1, bit(I, 2, 4) & !bit(I, 1, 4)));
    put(Q, 6, 1, bit(M, 33, 1) & !bit(M, 34, 0) & bit(I, 3, 4));
    if (bit(Q, 4, 5) & bit(I, 3, 7))
        put(M, 32, 7, true);
    if (bit(I, 1, 4) & !bit(I, 2, 5))
        put(M, 32, 7, false);
    put(M, 27, 2, (bit(M, 31, 1) & (bit(M, 32, 5) | !bit(Q, 0, 1))) | (bit(Q, 6, 1) & bit(I, 2, 0)));
    put(Q, 3, 7, (rdint(M + 50) > 1500) & bit(Q, 2, 5));
    put(M, 24, 0, rising(42, 2, bit(M, 27, 0) & !bit(I, 2, 6)));
    put(M, 32, 0, (bit(M, 34, 4) | !bit(M, 21, 2)) & !bit(Q, 0, 7));
    put(M, 29, 7, rising(42, 3, bit(Q, 5, 4) & !bit(M, 20, 0)));
    if (bit(M, 32, 7) & !bit(I, 0, 3))
        wr16(M + 56, (uint16_t)(rdint(M + 56) + 4));
    put(M, 35, 1, (rdint(M + 50) > 4000) & bit(I, 2, 2));
    put(M, 25, 0, (bit(I, 2, 7) & (bit(Q, 1, 4) | !bit(M, 25, 2))) | (bit(I, 2, 2) & bit(M, 30, 3)));
    put(Q, 4, 7, rising(42, 4, bit(Q, 0, 4) & !bit(I, 3, 2)));
    if (bit(I, 2, 5) & !bit(Q, 3, 0))
        wr16(M + 54, (uint16_t)(rdint(M + 54) + 8));
    if (bit(M, 27, 1) & bit(I, 1, 4))
        put(M, 25, 5, true);
    if (bit(M, 21, 4) & !bit(Q, 1, 3))
        put(M, 25, 5, false);
    put(Q, 2, 6, (bit(M, 28, 7) & (bit(M, 21, 6) | !bit(M, 35, 0))) | (bit(I, 3, 2) & bit(M, 24, 6)));
    put(M, 34, 2, (bit(M, 23, 4) | !bit(I, 3, 7)) & !bit(I, 1, 1));
    put(M, 32, 2, rising(42, 5, bit(M, 31, 0) & !bit(Q, 5, 0)));
    put(M, 21, 7, (bit(M, 27, 0) & (bit(Q, 5, 5) | !bit(M, 22, 0))) | (bit(M, 20, 7) & bit(Q, 2, 3)));
    put(M, 26, 0, (bit(I, 0, 7) | !bit(M, 23, 1)) & !bit(M, 23, 3));
    put(Q, 0, 7, (bit(Q, 0, 6) & (bit(I, 3, 4) | !bit(Q, 0, 7))) | (bit(I, 0, 6) & bit(M, 33, 4)));
    put(M, 28, 4, (bit(I, 3, 7) & (bit(Q, 5, 0) | !bit(M, 22, 5))) | (bit(Q, 2, 2) & bit(I, 0, 0)));
    put(M, 26, 5, (bit(Q, 2, 1) | !bit(Q, 0, 4)) & !bit(Q, 7, 3));
    put(M, 20, 3, (bit(Q, 5, 7) | !bit(I, 3, 4)) & !bit(I, 0, 7));
    put(Q, 1, 3, rising(42, 6, bit(I, 2, 0) & !bit(I, 1, 1)));
    if (bit(M, 33, 0) & bit(M, 27, 3))
        put(M, 21, 6, true);
    if (bit(I, 0, 3) & !bit(M, 23, 6))
        put(M, 21, 6, false);
    put(Q, 5, 1, bit(I, 3, 7) & !bit(Q, 0, 5) & bit(I, 2, 6));
    put(M, 25, 2, rising(42, 7, bit(M, 20, 0) & !bit(M, 22, 1)));
    if (bit(M, 33, 2) & bit(I, 2, 6))
        put(Q, 3, 5, true);
    if (bit(M, 29, 7) & !bit(M, 34, 0))
        put(Q, 3, 5, false);
    put(Q, 2, 1, bit(M, 30, 1) & !bit(M, 22, 2) & bit(M, 28, 3));
    if (bit(M, 20, 2) & !bit(M, 29, 5))
        wr16(M + 58, (uint16_t)(rdint(M + 58) + 7));
    put(M, 35, 0, (bit(M, 30, 7) & (bit(I, 2, 6) | !bit(I, 3, 7))) | (bit(Q, 0, 4) & bit(M, 29, 0)));
}
