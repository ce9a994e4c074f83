#include "../plc.h"

enum { A = 0, B = 256, C = 512, TRACE = 768, COUNT = 772 };

static uint8_t db1[COUNT + 2];

AREAS({"DB1.DB", db1, sizeof db1})

/* Rows and columns from 1, as in the program. */
static uint8_t *at(unsigned matrix, int row, int column)
{
    return db1 + matrix + 4 * (8 * (row - 1) + column - 1);
}

void scan(uint32_t now)
{
    (void)now;
    int count = (rdint(db1 + COUNT) + 1) % 64;
    wr16(db1 + COUNT, (uint16_t)count);
    int row = count / 8 + 1, column = count % 8 + 1;
    wrreal(at(A, row, column), (float)(row * column) * 0.125f);
    wrreal(at(B, column, row), (float)(row - column) * 0.25f + rdreal(db1 + TRACE) * 0.0001f);
    for (int i = 1; i <= 8; i++) {
        for (int j = 1; j <= 8; j++) {
            float sum = 0;
            for (int k = 1; k <= 8; k++) {
                sum += rdreal(at(A, i, k)) * rdreal(at(B, k, j));
            }
            wrreal(at(C, i, j), sum);
        }
    }
    float sum = 0;
    for (int i = 1; i <= 8; i++) {
        sum += rdreal(at(C, i, i));
    }
    wrreal(db1 + TRACE, sum);
    for (int i = 1; i <= 8; i++) {
        for (int j = i + 1; j <= 8; j++) {
            uint32_t other = rd32(at(A, i, j));
            wr32(at(A, i, j), rd32(at(A, j, i)));
            wr32(at(A, j, i), other);
        }
    }
}
