#include "../plc.h"
AREAS({"M", M, 11})
static struct { int state, floor, ticks; bool open, moving, up, waiting[6]; unsigned trips, served[6]; } e;
void scan(uint32_t now)
{
    (void)now;
    uint32_t s = rd32(M) + 0x9E3779B9u;
    wr32(M, s);
    wr32(M + 4, s ^ s >> 15);
    unsigned calls = M[4] & M[5] & M[6] & 0x3F;
    for (int i = 0; i < 6; i++) if (calls >> i & 1) e.waiting[i] = true;
    bool above = false, below = false;
    for (int i = 0; i < 6; i++) if (e.waiting[i]) { if (i > e.floor) above = true; else if (i < e.floor) below = true; }
    switch (e.state) {
    case 0:
        if (e.waiting[e.floor]) { e.state = 2; e.ticks = 0; }
        else if (above) { e.up = true; e.state = 1; e.trips++; }
        else if (below) { e.up = false; e.state = 1; e.trips++; }
        break;
    case 1:
        if (++e.ticks >= 4) {
            e.ticks = 0;
            if (e.up && e.floor < 5) e.floor++;
            else if (!e.up && e.floor > 0) e.floor--;
            if (e.waiting[e.floor]) e.state = 2;
            else if (e.up ? !above : !below) e.state = 0;
        }
        break;
    case 2:
        e.waiting[e.floor] = false;
        e.open = true;
        if (++e.ticks > 3) { e.served[e.floor]++; e.state = 3; }
        break;
    case 3:
        e.open = false; e.ticks = 0; e.state = 0;
        break;
    }
    e.moving = e.state == 1;
    wr16(M + 8, (uint16_t)e.floor);
    M[10] = (uint8_t)(e.open | e.moving << 1);
}
