#include "../plc.h"

enum { SEED = 0, COUNTERS = 4, ONES = 28, BINARY = 40, PARITY = 64 };

static uint8_t db1[PARITY + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static uint32_t add(uint32_t left, uint32_t right)
{
    uint32_t carry = 0, result = 0;
    for (int i = 0; i < 8; i++) {
        uint32_t sum = (left >> 4 * i & 15) + (right >> 4 * i & 15) + carry;
        carry = 0;
        if (sum > 9) {
            sum -= 10;
            carry = 1;
        }
        result |= sum << 4 * i;
    }
    return result;
}

static int ones(uint32_t bits)
{
    int count = 0;
    while (bits != 0) {
        count += bits & 1;
        bits >>= 1;
    }
    return count;
}

static int32_t binary(uint32_t bcd)
{
    int32_t value = 0;
    for (int i = 7; i >= 0; i--) {
        value = value * 10 + (int32_t)(bcd >> 4 * i & 15);
    }
    return value;
}

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = (rddint(db1 + SEED) * 421 + 1663) % 7875;
    wr32(db1 + SEED, (uint32_t)seed);
    unsigned parity = 0;
    for (int i = 1; i <= 6; i++) {
        uint32_t counter = add(rd32(db1 + COUNTERS + 4 * (i - 1)), (uint32_t)(seed + i) & 0x7777);
        wr32(db1 + COUNTERS + 4 * (i - 1), counter);
        int count = ones(counter);
        wr16(db1 + ONES + 2 * (i - 1), (uint16_t)count);
        wr32(db1 + BINARY + 4 * (i - 1), (uint32_t)binary(counter));
        if (count % 2 == 1) {
            parity |= 1u << i;
        }
    }
    wr16(db1 + PARITY, (uint16_t)parity);
}
