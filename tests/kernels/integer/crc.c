#include "../plc.h"

enum { TELEGRAM = 0, CRC = 24, SUM = 26, NUMBER = 28 };

static uint8_t db1[NUMBER + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static uint16_t crc16(const uint8_t *bytes, int length)
{
    uint16_t crc = 0xFFFF;
    for (int i = 0; i < length; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++) {
            crc = crc & 1 ? (uint16_t)(crc >> 1 ^ 0xA001) : (uint16_t)(crc >> 1);
        }
    }
    return crc;
}

void scan(uint32_t now)
{
    (void)now;
    int number = (rdint(db1 + NUMBER) + 1) % 10000;
    wr16(db1 + NUMBER, (uint16_t)number);
    for (int i = 0; i < 24; i++) {
        db1[TELEGRAM + i] = (uint8_t)(number + i * 29);
    }
    wr16(db1 + CRC, crc16(db1 + TELEGRAM, 24));
    int sum = 0;
    for (int i = 0; i < 24; i++) {
        sum += db1[TELEGRAM + i];
    }
    wr16(db1 + SUM, (uint16_t)sum);
}
