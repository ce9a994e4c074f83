#include "../plc.h"

/* A STRING[n] is its capacity, its length and n characters. */
enum { ANSWER = 0, NUMBER = 32, ARGUMENT = 34, POSITION = 36, UNKNOWN = 38, LONGEST = 40 };

static uint8_t db1[42] = {30};

AREAS({"DB1.DB", db1, sizeof db1})

struct text {
    unsigned length;
    char characters[40];
};

static void append(struct text *text, const char *characters, unsigned length)
{
    memcpy(text->characters + text->length, characters, length);
    text->length += length;
}

static bool is(const struct text *text, const char *what, unsigned length)
{
    return text->length == length && memcmp(text->characters, what, length) == 0;
}

static void answer(const char *characters, unsigned length)
{
    memcpy(db1 + ANSWER + 2, characters, length);
    db1[ANSWER + 1] = (uint8_t)length;
}

void scan(uint32_t now)
{
    (void)now;
    int number = (rdint(db1 + NUMBER) + 7) % 9001;
    wr16(db1 + NUMBER, (uint16_t)number);
    struct text line = {0}, name = {0};
    switch (number % 5) {
    case 0: append(&name, "move", 4); break;
    case 1: append(&name, "turn", 4); break;
    case 2: append(&name, "reset", 5); break;
    case 3: append(&name, "home", 4); break;
    default: append(&name, "jump", 4);
    }
    append(&line, name.characters, name.length);
    append(&line, " =", 2);
    char digits[6];
    unsigned count = 0, magnitude = (unsigned)abs(number - 4500);
    do {
        digits[count++] = (char)('0' + magnitude % 10);
        magnitude /= 10;
    } while (magnitude != 0);
    append(&line, number < 4500 ? "-" : "+", 1);
    while (count > 0) {
        append(&line, &digits[--count], 1);
    }

    unsigned at = 0;
    while (line.characters[at] != ' ' || line.characters[at + 1] != '=') {
        at++;
    }
    name.length = 0;
    append(&name, line.characters, at);
    const char *value = line.characters + at + 2;
    unsigned length = line.length - at - 2;
    int argument = 0;
    for (unsigned n = 1; n < length; n++) {
        argument = 10 * argument + (value[n] - '0');
    }
    if (value[0] == '-') {
        argument = -argument;
    }
    wr16(db1 + ARGUMENT, (uint16_t)argument);
    answer("done", 4);
    if (is(&name, "move", 4)) {
        wr16(db1 + POSITION, (uint16_t)(rd16(db1 + POSITION) + argument));
    } else if (is(&name, "turn", 4)) {
        wr16(db1 + POSITION, (uint16_t)-rd16(db1 + POSITION));
    } else if (is(&name, "reset", 5)) {
        wr16(db1 + POSITION, 0);
        struct text whole = {0};
        append(&whole, "at ", 3);
        append(&whole, value, length);
        append(&whole, " now", 4);
        answer(whole.characters, whole.length);
    } else if (name.length > 0 && name.characters[0] >= 'i') {
        wr16(db1 + UNKNOWN, (uint16_t)(rd16(db1 + UNKNOWN) + 1));
        append(&name, "?", 1);
        answer(name.characters, name.length);
    } else {
        unsigned kept = line.length - 1 < 6 ? line.length - 1 : 6;
        answer(line.characters + 1, kept);
    }
    if (db1[ANSWER + 1] > rdint(db1 + LONGEST)) {
        wr16(db1 + LONGEST, db1[ANSWER + 1]);
    }
}
