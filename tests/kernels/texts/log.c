#define _GNU_SOURCE
#include "../plc.h"

enum { LINE = 32, WORD = 4 * LINE, NAME = WORD + 12, PLACE = NAME + 8, FOUND = PLACE + 2, LENGTH = FOUND + 2 };

static uint8_t db1[LENGTH + 2] = {30, 0, [LINE] = 30, [2 * LINE] = 30, [3 * LINE] = 30, [WORD] = 10, [NAME] = 6, 5, 'm', 'o', 't', 'o', 'r'};

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

static char *digits(char *at, unsigned number, unsigned width)
{
    for (unsigned n = width; n > 0; n--) {
        at[n - 1] = (char)('0' + number % 10);
        number /= 10;
    }
    return at + width;
}

static char *append(char *at, const void *text, unsigned length)
{
    memcpy(at, text, length);
    return at + length;
}

static void set(uint8_t *text, const void *from, unsigned length)
{
    text[1] = (uint8_t)length;
    memcpy(text + 2, from, length);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    unsigned n = rd16(M + 4) & 0xFFF;
    char line[30], *at = digits(line, n / 60 % 24, 2);
    *at++ = ':';
    at = digits(at, n % 60, 2);
    *at++ = ' ';
    at = append(at, db1 + NAME + 2, db1[NAME + 1]);
    if (bit(M, 7, 0)) {
        at = append(at, " stopped", 8);
    } else {
        at = digits(append(at, " at ", 4), rd16(M + 6) & 0x7FF, 4);
    }
    unsigned place = (rd16(db1 + PLACE) + 1) % 4;
    wr16(db1 + PLACE, (uint16_t)place);
    set(db1 + LINE * place, line, (unsigned)(at - line));
    uint8_t *oldest = db1 + LINE * ((place + 1) % 4), *text = oldest + 2;
    unsigned length = oldest[1];
    if (memmem(text, length, "stop", 4) != NULL) {
        wr16(db1 + FOUND, (uint16_t)(rd16(db1 + FOUND) + 1));
        set(db1 + WORD, text + length - 7, 7);
    } else {
        unsigned rest = length < 6 ? 0 : length - 6;
        set(db1 + WORD, text + 6, rest < 5 ? rest : 5);
    }
    wr16(db1 + LENGTH, (uint16_t)length);
}
