#include "../plc.h"

enum { SEED = 0, LIST = 4, COPY = 68, MEDIAN = 132, FOUND = 134, SWAPS = 136, PLACE = 138 };

static uint8_t db1[PLACE + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static int word(unsigned array, int index)
{
    return rdint(db1 + array + 2 * index);
}

static void set(unsigned array, int index, int value)
{
    wr16(db1 + array + 2 * index, (uint16_t)value);
}

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = rddint(db1 + SEED);
    int place = word(PLACE, 0);
    for (int i = 0; i < 4; i++) {
        seed = (seed * 421 + 1663) % 7875;
        set(LIST, place, seed - 4000);
        place = (place + 7) % 32;
    }
    wr32(db1 + SEED, (uint32_t)seed);
    set(PLACE, 0, place);
    memcpy(db1 + COPY, db1 + LIST, 64);
    int swaps = 0;
    for (int i = 1; i < 32; i++) {
        int value = word(COPY, i);
        int j = i - 1;
        while (j >= 0 && word(COPY, j) > value) {
            set(COPY, j + 1, word(COPY, j));
            swaps++;
            j--;
        }
        set(COPY, j + 1, value);
    }
    set(SWAPS, 0, swaps);
    set(MEDIAN, 0, word(COPY, 16));
    int value = word(LIST, 5), low = 0, high = 31;
    while (low < high) {
        int middle = (low + high) / 2;
        if (word(COPY, middle) < value) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    set(FOUND, 0, low);
}
