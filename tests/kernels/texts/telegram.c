#include "../plc.h"

enum { VALUES = 64, KEYS = 76, GOOD = 80, LENGTH = 82 };

static uint8_t db1[84] = {[0 ... 63] = ' '};

AREAS({"M", M, 4}, {"DB1.DB", db1, sizeof db1})

static uint8_t hex(unsigned value)
{
    return (uint8_t)(value < 10 ? value + 48 : value + 55);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 1640531527u;
    wr32(M, seed);
    unsigned at = 0;
    for (unsigned i = 0; i < 3; i++) {
        db1[at++] = (uint8_t)(65 + i);
        db1[at++] = '=';
        int rest = (int)(seed >> 9 * i & 0xFFFF) - 20000;
        if (rest < 0) {
            db1[at++] = '-';
            rest = -rest;
        }
        uint8_t digits[12];
        unsigned n = 0;
        do {
            digits[n++] = (uint8_t)(rest % 10 + 48);
            rest /= 10;
        } while (rest != 0);
        while (n > 0) {
            db1[at++] = digits[--n];
        }
        db1[at++] = ';';
    }
    uint8_t sum = 0;
    for (unsigned i = 0; i < at; i++) {
        sum ^= db1[i];
    }
    db1[at++] = hex(sum >> 4);
    db1[at++] = hex(sum & 15);
    wr16(db1 + LENGTH, (uint16_t)at);

    const uint8_t *character = db1;
    uint8_t read = 0;
    for (unsigned field = 0; field < 3; field++) {
        db1[KEYS + field] = *character;
        read ^= character[0] ^ character[1];
        character += 2;
        int value = 0;
        bool negative = false;
        for (; *character != ';'; character++) {
            read ^= *character;
            if (*character == '-') {
                negative = true;
            } else {
                value = 10 * value + *character - 48;
            }
        }
        read ^= *character++;
        wr32(db1 + VALUES + 4 * field, (uint32_t)(negative ? -value : value));
    }
    if (character[0] == hex(read >> 4) && character[1] == hex(read & 15)) {
        wr16(db1 + GOOD, (uint16_t)(rd16(db1 + GOOD) + 1));
    }
}
