#include "../plc.h"

static uint8_t V[8] = {0x61, 0xC8, 0x86, 0x47};
static bool edges[25], runs;

AREAS({"V", V, 8}, {"M", M, 12}, {"Q", Q, 4})

static inline bool rising(unsigned edge, bool on)
{
    bool was = edges[edge];
    edges[edge] = on;
    return runs & on & !was;
}

void scan(uint32_t now)
{
    (void)now;
    wr32(V + 4, advance(V));
    bool on;
    if (bit(V, 7, 2) & bit(V, 7, 4))
        put(M, 3, 7, true);
    if (bit(V, 4, 0) & !bit(Q, 3, 2))
        put(M, 3, 7, false);
    put(Q, 0, 3, bit(Q, 2, 7) & !bit(V, 5, 4) & bit(Q, 0, 1));
    put(M, 1, 0, (bit(V, 7, 1) | !bit(M, 6, 1)) & (bit(V, 4, 3) | bit(V, 4, 7)) & !bit(Q, 3, 6));
    put(Q, 2, 4, bit(V, 6, 5) & !bit(V, 7, 1) & bit(V, 5, 1));
    if (bit(Q, 0, 6) & bit(Q, 1, 0))
        put(Q, 3, 2, true);
    if (bit(M, 4, 0) & !bit(V, 5, 6))
        put(Q, 3, 2, false);
    put(M, 0, 4, (bit(M, 4, 6) | !bit(V, 4, 1)) & (bit(V, 5, 0) | bit(M, 5, 7)) & !bit(V, 7, 2));
    if (bit(V, 5, 3) & bit(V, 5, 6))
        put(Q, 2, 2, true);
    if (bit(Q, 0, 6) & !bit(V, 4, 1))
        put(Q, 2, 2, false);
    if (bit(M, 2, 1) & bit(V, 5, 7))
        put(M, 7, 6, true);
    if (bit(V, 6, 3) & !bit(V, 4, 1))
        put(M, 7, 6, false);
    put(Q, 1, 0, (bit(M, 5, 2) | !bit(V, 6, 2)) & (bit(Q, 2, 2) | bit(V, 4, 7)) & !bit(M, 4, 0));
    put(Q, 0, 7, bit(M, 5, 2) & !bit(V, 4, 7) & bit(M, 0, 2));
    put(M, 6, 0, bit(Q, 0, 1) & !bit(V, 4, 1) & bit(M, 6, 5));
    on = bit(V, 4, 7) | bit(Q, 2, 0);
    put(Q, 0, 7, on & bit(M, 4, 2));
    put(M, 10, 6, on & !bit(V, 5, 5));
    on = bit(V, 7, 3) | bit(M, 3, 2);
    put(Q, 1, 6, on & bit(V, 7, 5));
    put(M, 11, 4, on & !bit(V, 4, 4));
    put(M, 7, 6, (bit(M, 7, 5) | !bit(V, 4, 4)) & (bit(V, 6, 5) | bit(M, 0, 2)) & !bit(Q, 3, 3));
    put(M, 2, 3, bit(V, 4, 7) & !bit(V, 6, 1) & bit(V, 5, 7));
    put(M, 2, 5, (bit(Q, 1, 1) | !bit(Q, 3, 2)) & (bit(Q, 3, 3) | bit(V, 7, 5)) & !bit(Q, 2, 3));
    put(Q, 1, 3, bit(Q, 0, 4) & !bit(M, 4, 0) & bit(M, 1, 0));
    put(Q, 0, 6, (bit(V, 6, 2) | !bit(Q, 1, 7)) & (bit(Q, 0, 3) | bit(Q, 2, 2)) & !bit(M, 4, 6));
    put(Q, 1, 4, rising(0, bit(M, 7, 3) & !bit(Q, 0, 0)));
    put(M, 6, 6, rising(1, bit(M, 3, 7) & !bit(Q, 1, 5)));
    put(Q, 1, 3, bit(V, 4, 4) & !bit(M, 5, 3) & bit(Q, 0, 7));
    if (bit(V, 5, 3) & bit(M, 2, 5))
        put(Q, 1, 3, true);
    if (bit(M, 3, 3) & !bit(V, 4, 2))
        put(Q, 1, 3, false);
    on = bit(Q, 1, 3) | bit(Q, 0, 1);
    put(M, 6, 1, on & bit(V, 6, 5));
    put(M, 8, 0, on & !bit(V, 6, 3));
    put(M, 3, 2, rising(2, bit(V, 4, 3) & !bit(V, 5, 4)));
    if (bit(M, 0, 0) & bit(V, 5, 6))
        put(M, 3, 6, true);
    if (bit(Q, 2, 5) & !bit(Q, 1, 2))
        put(M, 3, 6, false);
    put(M, 5, 3, bit(M, 4, 1) & !bit(V, 7, 2) & bit(M, 5, 6));
    on = bit(M, 0, 3) | bit(M, 4, 5);
    put(M, 0, 1, on & bit(V, 7, 2));
    put(M, 8, 1, on & !bit(V, 7, 7));
    put(Q, 2, 3, rising(3, bit(Q, 3, 0) & !bit(V, 7, 0)));
    put(Q, 1, 6, rising(4, bit(Q, 3, 2) & !bit(Q, 0, 6)));
    put(M, 0, 4, rising(5, bit(V, 5, 0) & !bit(V, 7, 6)));
    on = bit(Q, 1, 3) | bit(V, 4, 6);
    put(Q, 0, 0, on & bit(Q, 0, 3));
    put(M, 9, 6, on & !bit(V, 6, 2));
    if (bit(V, 6, 2) & bit(V, 7, 1))
        put(M, 5, 6, true);
    if (bit(M, 5, 4) & !bit(M, 3, 4))
        put(M, 5, 6, false);
    put(Q, 0, 0, rising(6, bit(V, 6, 4) & !bit(Q, 0, 0)));
    if (bit(M, 7, 2) & bit(V, 4, 7))
        put(M, 5, 3, true);
    if (bit(V, 7, 6) & !bit(M, 6, 2))
        put(M, 5, 3, false);
    on = bit(V, 7, 5) | bit(V, 4, 6);
    put(Q, 2, 6, on & bit(Q, 3, 4));
    put(M, 11, 5, on & !bit(V, 4, 4));
    on = bit(M, 5, 1) | bit(M, 7, 4);
    put(Q, 2, 3, on & bit(Q, 2, 7));
    put(M, 10, 0, on & !bit(M, 3, 6));
    on = bit(M, 6, 2) | bit(V, 5, 1);
    put(M, 3, 6, on & bit(Q, 2, 0));
    put(M, 8, 4, on & !bit(V, 4, 2));
    put(Q, 0, 5, rising(7, bit(M, 1, 5) & !bit(V, 4, 2)));
    on = bit(Q, 0, 0) | bit(Q, 2, 0);
    put(M, 7, 2, on & bit(Q, 0, 7));
    put(M, 9, 3, on & !bit(V, 6, 0));
    put(M, 5, 2, (bit(V, 7, 6) | !bit(M, 4, 0)) & (bit(Q, 2, 1) | bit(M, 2, 2)) & !bit(V, 7, 0));
    put(M, 5, 0, rising(8, bit(V, 5, 2) & !bit(M, 3, 3)));
    on = bit(V, 7, 3) | bit(Q, 0, 3);
    put(M, 5, 6, on & bit(V, 7, 4));
    put(M, 9, 6, on & !bit(V, 5, 0));
    put(Q, 1, 6, rising(9, bit(M, 2, 4) & !bit(V, 6, 0)));
    put(Q, 3, 7, rising(10, bit(V, 6, 0) & !bit(V, 7, 3)));
    on = bit(Q, 0, 5) | bit(V, 5, 1);
    put(M, 4, 1, on & bit(Q, 3, 1));
    put(M, 8, 7, on & !bit(Q, 0, 6));
    put(Q, 2, 2, bit(Q, 2, 5) & !bit(Q, 0, 4) & bit(V, 5, 6));
    if (bit(V, 4, 2) & bit(V, 5, 3))
        put(M, 1, 1, true);
    if (bit(Q, 0, 7) & !bit(V, 4, 3))
        put(M, 1, 1, false);
    if (bit(Q, 1, 3) & bit(V, 7, 7))
        put(M, 5, 1, true);
    if (bit(M, 6, 0) & !bit(Q, 2, 3))
        put(M, 5, 1, false);
    put(M, 7, 4, (bit(V, 7, 3) | !bit(M, 4, 1)) & (bit(V, 6, 4) | bit(V, 6, 2)) & !bit(V, 5, 0));
    put(Q, 1, 2, (bit(Q, 3, 5) | !bit(M, 1, 5)) & (bit(M, 7, 1) | bit(Q, 1, 3)) & !bit(V, 6, 2));
    on = bit(M, 5, 3) | bit(M, 2, 2);
    put(Q, 0, 1, on & bit(V, 7, 0));
    put(M, 9, 3, on & !bit(Q, 1, 2));
    if (bit(Q, 0, 6) & bit(V, 6, 2))
        put(M, 2, 0, true);
    if (bit(M, 3, 5) & !bit(V, 4, 2))
        put(M, 2, 0, false);
    if (bit(M, 7, 7) & bit(Q, 3, 1))
        put(M, 6, 6, true);
    if (bit(V, 6, 6) & !bit(Q, 0, 5))
        put(M, 6, 6, false);
    if (bit(V, 4, 7) & bit(V, 7, 0))
        put(M, 1, 4, true);
    if (bit(Q, 0, 3) & !bit(M, 6, 3))
        put(M, 1, 4, false);
    put(Q, 3, 3, rising(11, bit(V, 4, 1) & !bit(V, 4, 7)));
    if (bit(V, 4, 4) & bit(V, 7, 5))
        put(M, 5, 2, true);
    if (bit(M, 5, 7) & !bit(V, 7, 3))
        put(M, 5, 2, false);
    put(M, 7, 5, (bit(V, 5, 3) | !bit(V, 5, 0)) & (bit(V, 6, 5) | bit(M, 6, 2)) & !bit(M, 7, 6));
    put(Q, 2, 3, bit(V, 5, 4) & !bit(V, 5, 4) & bit(M, 5, 1));
    put(M, 7, 1, bit(V, 4, 0) & !bit(M, 4, 6) & bit(V, 5, 4));
    put(Q, 3, 7, (bit(V, 7, 0) | !bit(V, 4, 5)) & (bit(M, 7, 0) | bit(M, 2, 2)) & !bit(V, 7, 3));
    if (bit(Q, 1, 7) & bit(M, 0, 3))
        put(M, 4, 3, true);
    if (bit(V, 7, 2) & !bit(M, 2, 0))
        put(M, 4, 3, false);
    on = bit(V, 5, 2) | bit(V, 6, 6);
    put(Q, 0, 1, on & bit(V, 6, 4));
    put(M, 9, 7, on & !bit(Q, 0, 2));
    put(M, 5, 0, rising(12, bit(Q, 3, 5) & !bit(V, 4, 2)));
    put(M, 7, 4, bit(Q, 0, 0) & !bit(V, 6, 4) & bit(V, 5, 6));
    put(Q, 1, 0, rising(13, bit(Q, 0, 5) & !bit(V, 7, 6)));
    put(Q, 1, 7, rising(14, bit(Q, 1, 7) & !bit(M, 7, 7)));
    on = bit(M, 6, 3) | bit(M, 1, 5);
    put(M, 2, 0, on & bit(V, 5, 5));
    put(M, 11, 1, on & !bit(V, 5, 1));
    if (bit(M, 6, 3) & bit(Q, 0, 3))
        put(M, 0, 4, true);
    if (bit(V, 5, 0) & !bit(V, 6, 6))
        put(M, 0, 4, false);
    put(M, 7, 5, rising(15, bit(Q, 1, 3) & !bit(M, 7, 6)));
    put(Q, 3, 0, (bit(V, 6, 1) | !bit(V, 6, 1)) & (bit(M, 3, 4) | bit(V, 7, 1)) & !bit(Q, 3, 0));
    if (bit(Q, 2, 3) & bit(V, 7, 3))
        put(M, 4, 5, true);
    if (bit(Q, 1, 5) & !bit(V, 4, 5))
        put(M, 4, 5, false);
    put(M, 0, 4, rising(16, bit(Q, 0, 5) & !bit(V, 7, 4)));
    put(M, 5, 5, bit(M, 4, 2) & !bit(Q, 3, 5) & bit(M, 0, 3));
    put(M, 6, 7, bit(Q, 0, 2) & !bit(M, 4, 7) & bit(M, 7, 0));
    put(Q, 0, 6, (bit(V, 7, 1) | !bit(M, 4, 5)) & (bit(V, 4, 5) | bit(V, 7, 2)) & !bit(V, 5, 2));
    on = bit(Q, 2, 5) | bit(Q, 1, 3);
    put(M, 5, 4, on & bit(M, 5, 2));
    put(M, 11, 7, on & !bit(V, 4, 1));
    put(Q, 3, 6, bit(V, 6, 4) & !bit(Q, 3, 4) & bit(M, 5, 5));
    put(M, 2, 2, rising(17, bit(V, 7, 4) & !bit(V, 5, 0)));
    put(Q, 0, 1, bit(V, 6, 5) & !bit(V, 7, 5) & bit(V, 7, 2));
    if (bit(V, 6, 2) & bit(Q, 1, 1))
        put(M, 6, 2, true);
    if (bit(M, 7, 6) & !bit(V, 5, 5))
        put(M, 6, 2, false);
    on = bit(V, 4, 7) | bit(V, 6, 4);
    put(M, 5, 4, on & bit(V, 5, 1));
    put(M, 11, 2, on & !bit(V, 6, 1));
    put(M, 0, 7, (bit(Q, 2, 6) | !bit(V, 5, 4)) & (bit(M, 3, 4) | bit(V, 7, 0)) & !bit(V, 4, 2));
    put(Q, 2, 1, rising(18, bit(M, 0, 4) & !bit(V, 7, 0)));
    put(Q, 3, 7, rising(19, bit(Q, 2, 0) & !bit(V, 5, 3)));
    put(M, 4, 1, bit(M, 3, 2) & !bit(V, 4, 2) & bit(M, 3, 2));
    put(M, 0, 0, (bit(Q, 0, 6) | !bit(V, 6, 3)) & (bit(V, 5, 5) | bit(V, 4, 5)) & !bit(Q, 3, 3));
    if (bit(V, 7, 5) & bit(V, 6, 0))
        put(M, 4, 2, true);
    if (bit(V, 7, 0) & !bit(V, 6, 7))
        put(M, 4, 2, false);
    if (bit(Q, 1, 6) & bit(V, 4, 7))
        put(M, 6, 7, true);
    if (bit(Q, 2, 0) & !bit(V, 6, 2))
        put(M, 6, 7, false);
    put(M, 7, 3, rising(20, bit(Q, 0, 2) & !bit(Q, 0, 3)));
    on = bit(V, 4, 6) | bit(V, 7, 4);
    put(M, 7, 5, on & bit(V, 4, 1));
    put(M, 8, 2, on & !bit(Q, 3, 3));
    on = bit(V, 6, 3) | bit(M, 1, 6);
    put(Q, 2, 1, on & bit(V, 7, 0));
    put(M, 9, 6, on & !bit(Q, 3, 1));
    if (bit(M, 3, 3) & bit(V, 5, 2))
        put(Q, 2, 5, true);
    if (bit(Q, 0, 2) & !bit(M, 1, 4))
        put(Q, 2, 5, false);
    put(Q, 1, 1, (bit(M, 4, 6) | !bit(V, 5, 1)) & (bit(M, 6, 5) | bit(Q, 2, 7)) & !bit(V, 4, 1));
    on = bit(V, 6, 1) | bit(M, 1, 7);
    put(M, 7, 3, on & bit(V, 7, 6));
    put(M, 11, 5, on & !bit(V, 7, 3));
    on = bit(V, 5, 0) | bit(Q, 2, 2);
    put(M, 4, 4, on & bit(M, 6, 6));
    put(M, 9, 1, on & !bit(M, 5, 1));
    on = bit(M, 0, 2) | bit(Q, 0, 5);
    put(Q, 0, 5, on & bit(V, 7, 5));
    put(M, 9, 1, on & !bit(Q, 0, 3));
    put(Q, 3, 7, bit(V, 5, 7) & !bit(M, 2, 6) & bit(V, 4, 0));
    put(Q, 2, 5, (bit(V, 4, 5) | !bit(Q, 0, 1)) & (bit(M, 1, 1) | bit(V, 5, 1)) & !bit(M, 4, 5));
    put(Q, 3, 6, (bit(V, 5, 7) | !bit(V, 4, 7)) & (bit(V, 4, 2) | bit(V, 5, 6)) & !bit(V, 7, 0));
    put(Q, 3, 1, (bit(V, 6, 0) | !bit(Q, 0, 7)) & (bit(M, 0, 6) | bit(Q, 2, 1)) & !bit(V, 6, 1));
    if (bit(V, 4, 6) & bit(M, 4, 4))
        put(M, 3, 7, true);
    if (bit(V, 6, 1) & !bit(Q, 3, 6))
        put(M, 3, 7, false);
    if (bit(V, 5, 6) & bit(M, 6, 3))
        put(Q, 2, 0, true);
    if (bit(V, 6, 0) & !bit(M, 5, 7))
        put(Q, 2, 0, false);
    on = bit(M, 3, 5) | bit(M, 4, 3);
    put(M, 0, 1, on & bit(V, 6, 2));
    put(M, 10, 4, on & !bit(Q, 0, 5));
    if (bit(M, 1, 1) & bit(Q, 1, 4))
        put(M, 1, 6, true);
    if (bit(M, 0, 5) & !bit(V, 5, 4))
        put(M, 1, 6, false);
    put(M, 2, 1, bit(M, 0, 3) & !bit(V, 7, 6) & bit(M, 1, 2));
    put(M, 1, 5, bit(V, 6, 1) & !bit(V, 7, 4) & bit(V, 5, 1));
    if (bit(Q, 1, 7) & bit(Q, 3, 6))
        put(M, 6, 0, true);
    if (bit(Q, 0, 2) & !bit(M, 3, 0))
        put(M, 6, 0, false);
    if (bit(M, 2, 7) & bit(Q, 2, 1))
        put(M, 7, 7, true);
    if (bit(Q, 1, 4) & !bit(M, 6, 0))
        put(M, 7, 7, false);
    if (bit(V, 5, 6) & bit(Q, 3, 7))
        put(Q, 3, 3, true);
    if (bit(V, 5, 2) & !bit(V, 6, 2))
        put(Q, 3, 3, false);
    put(M, 7, 5, rising(21, bit(V, 7, 5) & !bit(M, 1, 3)));
    on = bit(M, 1, 3) | bit(M, 0, 2);
    put(M, 4, 1, on & bit(M, 4, 4));
    put(M, 8, 4, on & !bit(M, 2, 4));
    on = bit(V, 4, 2) | bit(M, 4, 0);
    put(Q, 1, 6, on & bit(Q, 2, 3));
    put(M, 10, 3, on & !bit(Q, 3, 5));
    put(Q, 2, 1, bit(V, 4, 1) & !bit(V, 6, 4) & bit(M, 2, 0));
    if (bit(Q, 1, 1) & bit(Q, 1, 7))
        put(Q, 2, 1, true);
    if (bit(V, 4, 7) & !bit(V, 4, 2))
        put(Q, 2, 1, false);
    put(M, 2, 2, (bit(Q, 0, 7) | !bit(M, 2, 1)) & (bit(V, 4, 1) | bit(V, 6, 4)) & !bit(V, 7, 0));
    put(Q, 0, 1, (bit(M, 1, 3) | !bit(Q, 1, 6)) & (bit(M, 5, 3) | bit(M, 6, 0)) & !bit(V, 6, 0));
    put(M, 5, 5, rising(22, bit(Q, 1, 6) & !bit(V, 5, 2)));
    put(M, 2, 0, rising(23, bit(M, 3, 1) & !bit(M, 5, 3)));
    put(Q, 2, 5, rising(24, bit(V, 4, 6) & !bit(V, 7, 3)));
    put(M, 6, 1, bit(V, 5, 1) & !bit(V, 5, 7) & bit(V, 6, 5));
    runs = true;
}
