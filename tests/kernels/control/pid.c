#include "../plc.h"

/* Channels of 12 bytes, then controllers of 42: the layout of the instance. */
enum { CHANNEL = 12, CONTROLLERS = 8 * CHANNEL, CONTROLLER = 40, COUNT = CONTROLLERS + 8 * CONTROLLER };
enum { SETPOINT = 0, VALUE = 4, GAIN = 8, TI = 12, TD = 16, CYCLE = 20, MANUAL = 24, OUTPUT = 26, SATURATED = 30, INTEGRAL = 32, LAST = 36 };
enum { LAG = 8 };

static uint8_t db1[COUNT + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static void controller(uint8_t *p)
{
    float error = rdreal(p + SETPOINT) - rdreal(p + VALUE);
    float derivative = (error - rdreal(p + LAST)) / rdreal(p + CYCLE);
    wrreal(p + LAST, error);
    if (bit(p, MANUAL, 0)) {
        wrreal(p + INTEGRAL, 0);
        wrreal(p + OUTPUT, rdreal(p + SETPOINT) * 0.5f);
        put(p, SATURATED, 0, false);
        return;
    }
    float integral = rdreal(p + INTEGRAL);
    float sum = rdreal(p + GAIN) * (error + integral + rdreal(p + TD) * derivative);
    if (sum > 100.0f) {
        wrreal(p + OUTPUT, 100.0f);
        put(p, SATURATED, 0, true);
    } else if (sum < 0.0f) {
        wrreal(p + OUTPUT, 0.0f);
        put(p, SATURATED, 0, true);
    } else {
        wrreal(p + OUTPUT, sum);
        put(p, SATURATED, 0, false);
        wrreal(p + INTEGRAL, integral + error * rdreal(p + CYCLE) / rdreal(p + TI));
    }
}

static void call(int index, float gain, float ti, float td, bool manual)
{
    const uint8_t *channel = db1 + CHANNEL * index;
    uint8_t *p = db1 + CONTROLLERS + CONTROLLER * index;
    memcpy(p, channel, 8);
    wrreal(p + GAIN, gain);
    wrreal(p + TI, ti);
    wrreal(p + TD, td);
    wrreal(p + CYCLE, 0.01f);
    put(p, MANUAL, 0, manual);
    controller(p);
}

void scan(uint32_t now)
{
    (void)now;
    int count = rdint(db1 + COUNT) + 1;
    if (count >= 50) {
        count = 0;
        for (int i = 0; i < 8; i++) {
            uint8_t *channel = db1 + CHANNEL * i;
            float setpoint = rdreal(channel + SETPOINT) + 7.5f;
            wrreal(channel + SETPOINT, setpoint > 90.0f ? (float)i + 10.0f : setpoint);
        }
    }
    wr16(db1 + COUNT, (uint16_t)count);
    call(0, 2.0f, 1.5f, 0.002f, count > 45);
    call(1, 1.5f, 1.0f, 0.003f, false);
    call(2, 3.0f, 2.5f, 0.001f, count < 3);
    call(3, 2.0f, 0.5f, 0.0f, false);
    call(4, 0.8f, 1.25f, 0.004f, false);
    call(5, 1.2f, 0.75f, 0.002f, count == 20);
    call(6, 2.2f, 3.0f, 0.001f, false);
    call(7, 4.0f, 2.0f, 0.0005f, false);
    for (int i = 0; i < 8; i++) {
        memcpy(db1 + CHANNEL * i + LAG, db1 + CONTROLLERS + CONTROLLER * i + OUTPUT, 4);
    }
    for (int i = 0; i < 8; i++) {
        uint8_t *channel = db1 + CHANNEL * i;
        float value = rdreal(channel + VALUE);
        wrreal(channel + VALUE, value + (rdreal(channel + LAG) - value) * (0.01f * (float)(i + 1)));
    }
}
