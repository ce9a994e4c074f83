#include "../plc.h"

/* A STRING[n] is its capacity, its length and n characters. */
enum { LINE = 0, PART = 82, HEAD = 104, NAMES = 126, NAME = 14, PLACE = NAMES + 8 * NAME, LENGTH = PLACE + 2, MATCH = PLACE + 4, NUMBER = PLACE + 6, WORDS = PLACE + 8 };

#define STRING(capacity, text) capacity, sizeof text - 1, text
#define ENTRY(text) {12, sizeof text - 1, text}

struct name {
    uint8_t capacity, length;
    char text[12];
};

static union {
    uint8_t bytes[WORDS + 2];
    struct {
        uint8_t line[82], part[22], head[22];
        struct name names[8];
    } parts;
} memory = {.parts = {{80}, {20}, {20}, {ENTRY("pump"), ENTRY("valve"), ENTRY("mixer"), ENTRY("heater"), ENTRY("conveyor"), ENTRY("press"), ENTRY("fan"), ENTRY("boiler")}}};

#define db1 memory.bytes

AREAS({"DB1.DB", memory.bytes, sizeof memory.bytes})

static void append(uint8_t *string, const char *text, unsigned length)
{
    unsigned room = string[0] - string[1];
    if (length > room) {
        length = room;
    }
    memcpy(string + 2 + string[1], text, length);
    string[1] += (uint8_t)length;
}

/* Position from 1 of `what` in `string`, or 0. */
static unsigned find(const uint8_t *string, const char *what, unsigned length)
{
    for (unsigned at = 0; at + length <= string[1]; at++) {
        if (memcmp(string + 2 + at, what, length) == 0) {
            return at + 1;
        }
    }
    return 0;
}

static void assign(uint8_t *string, const uint8_t *text, unsigned length)
{
    if (length > string[0]) {
        length = string[0];
    }
    memcpy(string + 2, text, length);
    string[1] = (uint8_t)length;
}

void scan(uint32_t now)
{
    (void)now;
    int number = (rdint(db1 + NUMBER) + 1) % 1000;
    wr16(db1 + NUMBER, (uint16_t)number);
    const struct name *name = memory.parts.names + number % 8, *other = memory.parts.names + (number + 3) % 8;
    uint8_t text[82] = {80};
    append(text, name->text, name->length);
    append(text, " is on, ", 8);
    append(text, other->text, other->length);
    append(text, " is off", 7);
    assign(db1 + LINE, text + 2, text[1]);
    wr16(db1 + LENGTH, text[1]);
    unsigned place = find(text, ", ", 2);
    wr16(db1 + PLACE, (uint16_t)place);
    assign(db1 + HEAD, text + 2, place - 1);
    uint8_t one[22] = {20};
    assign(one, text + 2 + place + 1, text[1] - place - 1);
    assign(db1 + PART, one + 2, one[1]);
    int match = -1;
    for (int i = 0; i < 8; i++) {
        if (find(one, memory.parts.names[i].text, memory.parts.names[i].length) == 1) {
            match = i;
            break;
        }
    }
    wr16(db1 + MATCH, (uint16_t)match);
    unsigned words = 1;
    for (unsigned i = 0; i < db1[LINE + 1]; i++) {
        words += db1[LINE + 2 + i] == ' ';
    }
    wr16(db1 + WORDS, (uint16_t)words);
}
