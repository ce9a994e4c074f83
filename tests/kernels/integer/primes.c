#include "../plc.h"

enum { SIEVE = 0, COUNT = 32, LARGEST = 34, LIMIT = 36, GCD = 38, NUMBER = 40 };

static uint8_t db1[NUMBER + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static bool is_set(int index)
{
    return db1[SIEVE + index / 8] >> index % 8 & 1;
}

void scan(uint32_t now)
{
    (void)now;
    int number = (rdint(db1 + NUMBER) + 1) % 1000;
    int limit = 200 + number % 56;
    wr16(db1 + NUMBER, (uint16_t)number);
    wr16(db1 + LIMIT, (uint16_t)limit);
    memset(db1 + SIEVE, 0xFF, 32);
    db1[SIEVE] = 0xFC;
    for (int i = 2; i <= 15; i++) {
        if (is_set(i)) {
            for (int k = i * i; k <= 255; k += i) {
                db1[SIEVE + k / 8] &= (uint8_t)~(1 << k % 8);
            }
        }
    }
    int count = 0, largest = rdint(db1 + LARGEST);
    for (int i = 0; i < limit; i++) {
        if (is_set(i)) {
            count++;
            largest = i;
        }
    }
    wr16(db1 + COUNT, (uint16_t)count);
    wr16(db1 + LARGEST, (uint16_t)largest);
    int a = 360 + number, b = 1024 - number;
    while (b != 0) {
        int rest = a % b;
        a = b;
        b = rest;
    }
    wr16(db1 + GCD, (uint16_t)a);
}
