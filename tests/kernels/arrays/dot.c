#include "../plc.h"

enum { A = 0, B = 512, DOT = 1024, LENGTH = 1028, DISTANCE = 1032, LARGEST = 1036, WHERE = 1040, STEP = 1042 };

static uint8_t db1[STEP + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static float element(unsigned array, int index)
{
    return rdreal(db1 + array + 4 * index);
}

void scan(uint32_t now)
{
    (void)now;
    int k = rdint(db1 + STEP);
    wrreal(db1 + A + 4 * k, (float)k * 0.25f - 7.0f);
    wrreal(db1 + B + 4 * k, element(A, k) * 0.5f + element(B, (k + 5) % 128) * 0.25f);
    wr16(db1 + STEP, (uint16_t)((k + 3) % 128));
    float dot = 0, length = 0;
    for (int i = 0; i < 128; i++) {
        dot += element(A, i) * element(B, i);
        length += element(A, i) * element(A, i);
    }
    float distance = 0, largest = -1;
    for (int i = 0; i < 128; i++) {
        float difference = fabsf(element(A, i) - element(B, i));
        distance += difference;
        if (difference > largest) {
            largest = difference;
            k = i;
        }
    }
    wrreal(db1 + DOT, dot);
    wrreal(db1 + LENGTH, sqrtf(length));
    wrreal(db1 + DISTANCE, distance);
    wrreal(db1 + LARGEST, largest);
    wr16(db1 + WHERE, (uint16_t)k);
}
