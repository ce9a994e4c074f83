#include "../plc.h"

enum { FLOORS = 6 };

AREAS({"M", M, 11})

static struct {
    enum { IDLE, MOVE, DOOR, CLOSE } state;
    int floor, ticks;
    bool open, moving, up, waiting[FLOORS];
    unsigned trips, served[FLOORS];
} elevator;

static void start(bool up)
{
    elevator.up = up;
    elevator.state = MOVE;
    elevator.trips++;
}

static void move(bool above, bool below)
{
    if (++elevator.ticks < 4) {
        return;
    }
    elevator.ticks = 0;
    if (elevator.up && elevator.floor < FLOORS - 1) {
        elevator.floor++;
    } else if (!elevator.up && elevator.floor > 0) {
        elevator.floor--;
    }
    if (elevator.waiting[elevator.floor]) {
        elevator.state = DOOR;
    } else if (elevator.up ? !above : !below) {
        elevator.state = IDLE;
    }
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    unsigned calls = M[4] & M[5] & M[6] & 0x3F;
    bool above = false, below = false;
    for (int i = 0; i < FLOORS; i++) {
        elevator.waiting[i] |= calls >> i & 1;
        above |= elevator.waiting[i] && i > elevator.floor;
        below |= elevator.waiting[i] && i < elevator.floor;
    }
    switch (elevator.state) {
    case IDLE:
        if (elevator.waiting[elevator.floor]) {
            elevator.state = DOOR;
            elevator.ticks = 0;
        } else if (above || below) {
            start(above);
        }
        break;
    case MOVE:
        move(above, below);
        break;
    case DOOR:
        elevator.waiting[elevator.floor] = false;
        elevator.open = true;
        if (++elevator.ticks > 3) {
            elevator.served[elevator.floor]++;
            elevator.state = CLOSE;
        }
        break;
    case CLOSE:
        elevator.open = false;
        elevator.ticks = 0;
        elevator.state = IDLE;
        break;
    }
    elevator.moving = elevator.state == MOVE;
    wr16(M + 8, (uint16_t)elevator.floor);
    M[10] = (uint8_t)(elevator.open | elevator.moving << 1);
}
