#include "../plc.h"

static uint8_t V[256] = {0x61, 0xC8, 0x86, 0x47};
static bool edges[12], runs;

AREAS({"V", V, 212})

void scan(uint32_t now)
{
    (void)now;
    static const float factors[12] = {0.05f, 0.06f, 0.07f, 0.08f, 0.09f, 0.10f, 0.11f, 0.12f, 0.13f, 0.14f, 0.15f, 0.16f};
    uint32_t seed = advance(V);
    int alarms = rdint(V + 210);
    for (unsigned i = 0; i < 12; i++) {
        uint8_t *channel = V + 40 + 8 * i;
        float value = (float)(int)(seed >> (4 + i) & 0x3FFF) * 0.0061f;
        float filtered = rdreal(channel);
        filtered += (value - filtered) * factors[i];
        wrreal(channel, filtered);
        float slow = rdreal(channel + 4), change = filtered - slow;
        change = change > 0.5f ? 0.5f : change;
        change = change < -0.5f ? -0.5f : change;
        slow += change;
        wrreal(channel + 4, slow);
        bool alarm = bit(V, 200 + i / 8, i % 8);
        if (slow > 54.0f + 0.5f * (float)i) {
            alarm = true;
        }
        if (slow < 45.0f + 0.5f * (float)i) {
            alarm = false;
        }
        put(V, 200 + i / 8, i % 8, alarm);
        alarms += runs & alarm & !edges[i];
        edges[i] = alarm;
    }
    runs = true;
    wr16(V + 210, (uint16_t)alarms);
}
