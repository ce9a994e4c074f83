#include "../plc.h"

AREAS({"M", M, 12})

static uint8_t telegram[122] = {120};

/* A sign, also `+`, and the digits. */
static unsigned to_text(int value, char *text)
{
    char digits[8];
    unsigned count = 0, magnitude = (unsigned)abs(value);
    do {
        digits[count++] = (char)('0' + magnitude % 10);
        magnitude /= 10;
    } while (magnitude != 0);
    *text++ = value < 0 ? '-' : '+';
    for (unsigned n = 0; n < count; n++) {
        text[n] = digits[count - 1 - n];
    }
    return count + 1;
}

void scan(uint32_t now)
{
    (void)now;
    int number = (rdint(M) + 1) % 3000;
    wr16(M, (uint16_t)number);
    char *text = (char *)telegram + 2;
    unsigned length = 0;
    text[length++] = 'S';
    for (int i = 1; i <= 6; i++) {
        length += to_text((int16_t)(number * i - 1500), text + length);
        text[length++] = ';';
    }
    telegram[1] = (uint8_t)length;
    int total = 0;
    const char *at = text + 1, *end = text + length;
    while (at < end) {
        const char *stop = memchr(at, ';', (size_t)(end - at));
        if (stop == NULL) {
            break;
        }
        bool negative = *at == '-';
        int value = 0;
        for (at++; at < stop; at++) {
            value = 10 * value + (*at - '0');
        }
        total += negative ? -value : value;
        at = stop + 1;
    }
    wr32(M + 4, (uint32_t)total);
    wr16(M + 8, (uint16_t)length);
    M[10] = (uint8_t)text[8];
    M[11] = (uint8_t)text[14];
}
