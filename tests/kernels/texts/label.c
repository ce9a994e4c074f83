#include "../plc.h"

enum { CODE = 0, LINE = 18, PART = 60, NUMBER = 78, TAIL = 92, COUNT = 102, AT = 106, LONG = 108, LEFT = 110, TEXT = 132 };

static uint8_t db1[TEXT + 42] = {[CODE] = 16, 9, 'A', 'B', '-', '1', '2', '0', '0', '-', 'X', [LINE] = 40, [PART] = 16, [NUMBER] = 12, [TAIL] = 8, [LEFT] = 20, [TEXT] = 40};

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

static void set(uint8_t *text, const void *from, unsigned length)
{
    text[1] = (uint8_t)length;
    memcpy(text + 2, from, length);
}

static unsigned decimal(char *to, uint32_t value)
{
    char digits[12];
    unsigned count = 0, length = 0;
    do {
        digits[count++] = (char)('0' + value % 10);
        value /= 10;
    } while (value != 0);
    to[length++] = '+';
    while (count > 0) {
        to[length++] = digits[--count];
    }
    return length;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    char number[12], text[48], line[48];
    unsigned digits = decimal(number, rd32(M + 4) & 0xFFFF);
    set(db1 + NUMBER, number, digits);
    unsigned length = db1[CODE + 1];
    memcpy(text, db1 + CODE + 2, length);
    text[length++] = '/';
    set(db1 + LEFT, text, length);
    memcpy(text + length, number, digits);
    length += digits;
    const char *dash = memchr(text, '-', length);
    unsigned at = dash != NULL ? (unsigned)(dash - text) + 1 : 0;
    unsigned rest = length - at;
    set(db1 + PART, text + at - 1, 4);
    set(db1 + TAIL, text + length - 3, 3);
    memcpy(line, text + length - 3, 3);
    memcpy(line + 3, " <", 2);
    memcpy(line + 5, text + 2, length - 2);
    length += 3;
    set(db1 + TEXT, line, length);
    set(db1 + LINE, line, length < 20 ? length : 20);
    if (db1[TAIL + 1] == db1[PART + 1] && memcmp(db1 + TAIL + 2, db1 + PART + 2, db1[TAIL + 1]) == 0) {
        wr32(db1 + COUNT, rd32(db1 + COUNT) + 1);
    }
    wr16(db1 + AT, (uint16_t)at);
    wr16(db1 + LONG, (uint16_t)rest);
}
