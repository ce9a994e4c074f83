#include "../plc.h"

/* Instances; bits are the first of their byte. */
enum { R_TARGET = 0, R_UP = 4, R_DOWN = 8, R_VALUE = 12, R_MOVING = 16, RAMP_SIZE = 18 };
enum { C_SETPOINT = 0, C_ACTUAL = 4, C_GAIN = 8, C_RESET = 12, C_BAND = 16, C_OUTPUT = 20, C_LIMITED = 24, C_INTEGRAL = 26, CONTROLLER_SIZE = 30 };
enum { V_TARGET = 0, V_LOAD = 4, V_TEMPERATURE = 8, V_RAMP = 12, V_OUTER = V_RAMP + RAMP_SIZE, V_INNER = V_OUTER + CONTROLLER_SIZE, V_JACKET = V_INNER + CONTROLLER_SIZE };
enum { SEED = 0, TARGET = 4, COUNT = 8, WARM = 10 };

#define TWENTY 0x41, 0xA0, 0, 0
#define CONTROLLER(at) [(at) + C_GAIN] = 0x40, 0, 0, 0, 0x3D, 0x4C, 0xCC, 0xCD, 0x3D, 0xCC, 0xCC, 0xCD
#define VESSEL {[V_TEMPERATURE] = TWENTY, CONTROLLER(V_OUTER), CONTROLLER(V_INNER), [V_JACKET] = TWENTY}

static uint8_t vessel1[V_JACKET + 4] = VESSEL, vessel2[V_JACKET + 4] = VESSEL, plant[WARM + 2];

AREAS({"DB1.DB", vessel1, sizeof vessel1}, {"DB2.DB", vessel2, sizeof vessel2}, {"DB3.DB", plant, sizeof plant})

static float ramp(uint8_t *at, float target, float up, float down)
{
    wrreal(at + R_TARGET, target);
    wrreal(at + R_UP, up);
    wrreal(at + R_DOWN, down);
    float value = rdreal(at + R_VALUE);
    if (value < target) {
        value += up;
        if (value > target) {
            value = target;
        }
    } else if (value > target) {
        value -= down;
        if (value < target) {
            value = target;
        }
    }
    wrreal(at + R_VALUE, value);
    put(at, R_MOVING, 0, value != target);
    return value;
}

static float control(uint8_t *at, float setpoint, float actual)
{
    wrreal(at + C_SETPOINT, setpoint);
    wrreal(at + C_ACTUAL, actual);
    float error = setpoint - actual;
    if (fabsf(error) < rdreal(at + C_BAND)) {
        error = 0;
    }
    float integral = rdreal(at + C_INTEGRAL), sum = rdreal(at + C_GAIN) * error + integral;
    bool limited = sum > 100.0f || sum < 0.0f;
    float output = sum < 0.0f ? 0.0f : sum > 100.0f ? 100.0f : sum;
    put(at, C_LIMITED, 0, limited);
    wrreal(at + C_OUTPUT, output);
    if (!limited) {
        wrreal(at + C_INTEGRAL, integral + error * rdreal(at + C_RESET));
    }
    return output;
}

static float vessel(uint8_t *at, float target, float load)
{
    wrreal(at + V_TARGET, target);
    wrreal(at + V_LOAD, load);
    float temperature = rdreal(at + V_TEMPERATURE), jacket = rdreal(at + V_JACKET);
    wrreal(at + V_OUTER + C_GAIN, 3.0f);
    wrreal(at + V_INNER + C_GAIN, 1.5f);
    wrreal(at + V_INNER + C_RESET, 0.1f);
    float setpoint = control(at + V_OUTER, ramp(at + V_RAMP, target, 0.25f, 0.5f), temperature);
    jacket += (control(at + V_INNER, setpoint, jacket) - jacket) * 0.2f;
    temperature = temperature + (jacket - temperature) * 0.05f - load * 0.01f;
    wrreal(at + V_JACKET, jacket);
    wrreal(at + V_TEMPERATURE, temperature);
    return temperature;
}

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = (rddint(plant + SEED) * 421 + 1663) % 7875;
    wr32(plant + SEED, (uint32_t)seed);
    float load = (float)seed / 7875.0f;
    int count = rdint(plant + COUNT) + 1;
    if (count > 100) {
        count = 0;
        wrreal(plant + TARGET, 30.0f + load * 40.0f);
    }
    wr16(plant + COUNT, (uint16_t)count);
    float first = vessel(vessel1, rdreal(plant + TARGET), load), second = vessel(vessel2, first, 1.0f - load);
    if (first > 40.0f && second > 35.0f) {
        wr16(plant + WARM, (uint16_t)(rd16(plant + WARM) + 1));
    }
}
