#include "../plc.h"

static uint8_t display[82 + 22 + 6 + 30] = {80};

AREAS({"M", M, 14}, {"DB1.DB", display, 104})

static const char *const names[] = {"pump", "fan", "belt"};

static unsigned column(char *line, unsigned length, const char *name, int value)
{
    char digits[8];
    unsigned count = 0, magnitude = (unsigned)abs(value), name_length = (unsigned)strlen(name);
    do {
        digits[count++] = (char)('0' + magnitude % 10);
        magnitude /= 10;
    } while (magnitude != 0);
    digits[count++] = value < 0 ? '-' : '+';
    memcpy(line + length, name, name_length);
    length += name_length;
    for (unsigned n = count; n < 6; n++) {
        line[length++] = ' ';
    }
    while (count > 0) {
        line[length++] = digits[--count];
    }
    line[length++] = ' ';
    return length;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    char *line = (char *)display + 2;
    unsigned length = column(line, 0, names[0], rdint(M + 4) / 4);
    length = column(line, length, names[1], rd16(M + 6) & 0x3FF);
    length = column(line, length, names[2], rdint(M + 5) % 100);
    memcpy(line + length, "rpm", 3);
    length += 3;
    const char *minus = memchr(line, '-', length);
    unsigned at = minus != NULL ? (unsigned)(minus - line) + 1 : 0;
    if (at > 0) {
        line[at - 1] = '<';
    } else {
        memmove(line + 5, line + 4, length - 4);
        line[4] = '>';
        length++;
    }
    display[0] = 80;
    display[1] = (uint8_t)length;
    display[82] = 20;
    display[83] = 12;
    memcpy(display + 84, line + 4, 12);
    wr16(M + 8, (uint16_t)at);
    wr16(M + 10, (uint16_t)length);
    int order = memcmp(display + 84, " fan", 4);
    if (order >= 0) {
        wr16(M + 12, (uint16_t)(rd16(M + 12) + 1));
    }
}
