#include "../plc.h"

enum { NAME = 0, PLACE = 18, STOCK = 26, PRICE = 28, ARTICLE = 32, LINE = 8 * ARTICLE, WANTED = LINE + 62, FOUND = WANTED + 18, MOVES = FOUND + 2, MISSING = MOVES + 2 };

#define ROW(n) [n * ARTICLE + NAME] = 16, [n * ARTICLE + PLACE] = 6

static uint8_t store[MISSING + 2] = {ROW(0), ROW(1), ROW(2), ROW(3), ROW(4), ROW(5), ROW(6), ROW(7), [LINE] = 60, [WANTED] = 16};

AREAS({"DB1.DB", store, sizeof store}, {"M", M, 8})

static const char *const names[] = {"bolt M8", "nut M8", "washer 8", "bolt M10", "nut M10", "washer 10", "pin 6", "clip"};
static const char *const places[] = {"A01", "A02", "B01", "B02", "C01", "C02", "D01", "D02"};

static void set(uint8_t *text, const void *from, unsigned length)
{
    text[1] = (uint8_t)length;
    memcpy(text + 2, from, length);
}

static int search(const uint8_t *name)
{
    for (int i = 0; i < 8; i++) {
        const uint8_t *other = store + ARTICLE * i + NAME;
        if (other[1] == name[1] && memcmp(other + 2, name + 2, name[1]) == 0) {
            return i;
        }
    }
    return -1;
}

static unsigned put_text(char *to, unsigned length, const void *from, unsigned count)
{
    memcpy(to + length, from, count);
    return length + count;
}

static unsigned put_number(char *to, unsigned length, int value)
{
    char digits[8];
    unsigned count = 0, magnitude = (unsigned)abs(value);
    do {
        digits[count++] = (char)('0' + magnitude % 10);
        magnitude /= 10;
    } while (magnitude != 0);
    digits[count++] = value < 0 ? '-' : '+';
    while (count > 0) {
        to[length++] = digits[--count];
    }
    return length;
}

static void describe(uint8_t *line, const uint8_t *article)
{
    char text[60];
    unsigned length = put_text(text, 0, article + PLACE + 2, article[PLACE + 1]);
    length = put_text(text, length, ": ", 2);
    length = put_text(text, length, article + NAME + 2, article[NAME + 1]);
    if (rdint(article + STOCK) < 10) {
        length = put_text(text, length, " (low)", 6);
    } else {
        length = put_number(text, put_text(text, length, " x", 2), rdint(article + STOCK));
    }
    set(line, text, length);
}

void scan(uint32_t now)
{
    if (now == 0) {
        for (int i = 0; i < 8; i++) {
            set(store + ARTICLE * i + NAME, names[i], (unsigned)strlen(names[i]));
            set(store + ARTICLE * i + PLACE, places[i], 3);
        }
    }
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    int other = rd16(M + 4) & 7;
    if (bit(M, 7, 7)) {
        const uint8_t *name = store + ARTICLE * other + NAME;
        set(store + WANTED, name + 2, name[1]);
    } else {
        set(store + WANTED, "washer 10", 9);
    }
    int at = search(store + WANTED);
    if (at >= 0) {
        uint8_t *article = store + ARTICLE * at;
        wr16(store + FOUND, (uint16_t)(rd16(store + FOUND) + 1));
        int stock = rdint(article + STOCK) + (rd16(M + 6) & 0x1F) - 14;
        wr16(article + STOCK, (uint16_t)(stock < 0 ? 100 : stock));
        describe(store + LINE, article);
        if (at != other) {
            uint8_t kept[ARTICLE];
            memcpy(kept, article, ARTICLE);
            memcpy(article, store + ARTICLE * other, ARTICLE);
            memcpy(store + ARTICLE * other, kept, ARTICLE);
            wr16(store + MOVES, (uint16_t)(rd16(store + MOVES) + 1));
        }
    } else {
        wr16(store + MISSING, (uint16_t)(rd16(store + MISSING) + 1));
    }
    if (store[NAME + 1] >= 3 && memcmp(store + NAME + 2, "nut", 3) == 0) {
        unsigned rest = store[LINE + 1];
        set(store + PLACE, store + LINE + 2, rest < 3 ? rest : 3);
    }
}
