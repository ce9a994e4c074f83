#include "../plc.h"

enum { FIRST = 0, SECOND = 32, THIRD = 64, SUMS = 104, MEDIANS = 110 };

static uint8_t lists[MEDIANS + 4];

AREAS({"M", M, 8}, {"DB1.DB", lists, sizeof lists})

static int fill(int32_t value, uint8_t *list, unsigned length)
{
    int16_t sum = 0;
    for (unsigned i = 0; i < length; i++) {
        value = (value * 31 + 7) % 1000;
        wr16(list + 2 * i, (uint16_t)value);
        sum = (int16_t)(sum + value);
    }
    return sum;
}

static int sort(int count, uint8_t *list)
{
    for (int i = 1; i < count; i++) {
        int16_t value = rdint(list + 2 * i);
        int j = i - 1;
        for (; j >= 0 && rdint(list + 2 * j) > value; j--) {
            memcpy(list + 2 * j + 2, list + 2 * j, 2);
        }
        wr16(list + 2 * j + 2, (uint16_t)value);
    }
    return rdint(list + 2 * (count / 2));
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    int sum = fill(rd16(M + 4) & 0x3FF, lists + FIRST, 16);
    wr16(lists + SUMS, (uint16_t)sum);
    wr16(lists + SUMS + 2, (uint16_t)fill(rd16(M + 6) & 0x3FF, lists + SECOND, 16));
    wr16(lists + SUMS + 4, (uint16_t)fill(sum, lists + THIRD, 20));
    wr16(lists + MEDIANS, (uint16_t)sort(16, lists + FIRST));
    wr16(lists + MEDIANS + 2, (uint16_t)sort(12, lists + SECOND));
}
