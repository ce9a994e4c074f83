#include "../plc.h"

enum { FIELDS = 62, WIDTH = 14, COUNT = 146, LETTERS = 148 };

static uint8_t record[150] = {
    60,  23,  'w', '1', '0', '0', '0', ';', 'b', 'o',           'l',           't',           ';',           'm',           '8',
    ';', '-', '2', '5', ';', 's', 't', 'e', 'e', 'l', [62] = 12, [76] = 12, [90] = 12, [104] = 12, [118] = 12, [132] = 12};

AREAS({"M", M, 8}, {"DB1.DB", record, 150})

static void set_field(unsigned n, const uint8_t *from, unsigned length)
{
    uint8_t *field = record + FIELDS + n * WIDTH;
    field[1] = (uint8_t)length;
    memcpy(field + 2, from, length);
}

static unsigned split(const uint8_t *text, uint8_t delimiter)
{
    unsigned length = text[1], start = 0, n = 0;
    const uint8_t *characters = text + 2;
    for (unsigned i = 0; i < length; i++) {
        if (characters[i] == delimiter) {
            set_field(n++, characters + start, i - start);
            start = i + 1;
        }
    }
    set_field(n, characters + start, length - start);
    return n + 1;
}

static unsigned letters(const uint8_t *text)
{
    unsigned n = 0;
    for (unsigned i = 0; i < text[1]; i++) {
        n += text[2 + i] >= 'a' && text[2 + i] <= 'z';
    }
    return n;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    uint8_t *line = record + 2;
    line[0] = (uint8_t)('a' + (rd16(M + 4) & 15));
    unsigned bits = rd16(M + 6);
    for (unsigned i = 1; i < 5; i++) {
        line[i] = (uint8_t)('0' + bits % 10);
        bits /= 10;
    }
    line[12] = bit(M, 5, 6) ? ';' : '8';
    wr16(record + COUNT, (uint16_t)split(record, ';'));
    wr16(record + LETTERS, (uint16_t)letters(record));
}
