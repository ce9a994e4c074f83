#include "../plc.h"

enum { TEXT = 2, VALUES = 42, GOOD = 58, BAD = 62 };

static uint8_t line[66] = {40, 12, '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.'};

AREAS({"DB1.DB", line, sizeof line}, {"M", M, 8})

static int hex(unsigned digit)
{
    return digit - '0' < 10 ? (int)digit - '0' : digit - 'A' < 6 ? (int)digit - 'A' + 10 : -1;
}

static void parse(const uint8_t *text, unsigned length)
{
    enum { IDLE, LETTER, NUMBER, HIGH, LOW, LAST, COMPLETE, WRONG } state = IDLE;
    unsigned sum = 0, field = 0;
    int32_t value = 0;
    bool negative = false;
    for (unsigned n = 0; n < length && state != WRONG; n++) {
        unsigned c = text[n];
        switch (state) {
        case IDLE:
            if (c == 2) {
                state = LETTER;
            }
            break;
        case LETTER:
            sum += c;
            field = c - 'A';
            state = field < 4 ? NUMBER : WRONG;
            break;
        case NUMBER:
            sum += c;
            if (c == '-') {
                negative = true;
            } else if (c - '0' < 10) {
                value = 10 * value + (int32_t)c - '0';
            } else {
                state = c == '*' ? HIGH : WRONG;
            }
            break;
        case HIGH: state = hex(c) == (int)(sum >> 4 & 15) ? LOW : WRONG; break;
        case LOW: state = hex(c) == (int)(sum & 15) ? LAST : WRONG; break;
        case LAST:
            if (c == 3) {
                state = COMPLETE;
            }
            break;
        default: break;
        }
    }
    if (state == COMPLETE) {
        wr32(line + VALUES + 4 * field, (uint32_t)(negative ? -value : value));
        wr32(line + GOOD, rd32(line + GOOD) + 1);
    } else {
        wr32(line + BAD, rd32(line + BAD) + 1);
    }
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    uint8_t *text = line + TEXT, *at = text;
    *at++ = 2;
    *at++ = (uint8_t)('A' + (rd16(M + 4) & 3));
    if (bit(M, 5, 6)) {
        *at++ = '-';
    }
    unsigned number = rd16(M + 6);
    for (int n = 0; n < 5; n++) {
        *at++ = (uint8_t)('0' + number % 10);
        number /= 10;
    }
    *at++ = '*';
    unsigned sum = 0;
    for (const uint8_t *c = text + 1; c < at; c++) {
        sum += *c;
    }
    if ((rd16(M + 4) & 0x70) == 0) {
        sum++;
    }
    *at++ = (uint8_t)"0123456789ABCDEF"[sum >> 4 & 15];
    *at++ = (uint8_t)"0123456789ABCDEF"[sum & 15];
    *at++ = 3;
    parse(line + TEXT, line[1]);
}
