#include "../plc.h"

enum { RUNNING = 0, FAULTS = 2, SERVICES = 4, POWER = 6, FIRST = 10 };

static uint8_t result[FIRST + 12];

AREAS({"DB2.DB", result, sizeof result}, {"M", M, 16})

struct pump {
    uint32_t hours;
    uint16_t starts;
    int16_t dry;
    float power, speed;
    bool running, fault, service, request;
};

static struct station {
    struct pump pumps[3];
    int wanted, running, faults, services;
    float power;
} stations[3];

static void run_pump(struct pump *p, bool protection, bool acknowledge, float rated)
{
    if (protection) {
        p->dry++;
        p->fault |= p->dry > 2;
    } else {
        p->dry = 0;
        if (acknowledge) {
            p->fault = false;
        }
    }
    bool was = p->running;
    p->running = p->request && !p->fault;
    if (p->running) {
        p->speed = p->speed + 0.125f < 1.0f ? p->speed + 0.125f : 1.0f;
        p->hours++;
        p->starts += !was;
    } else {
        p->speed = p->speed - 0.25f > 0.0f ? p->speed - 0.25f : 0.0f;
    }
    p->power = rated * p->speed * p->speed * p->speed;
    p->service = p->hours % 1000 > 900 || p->starts > 500;
}

static void run_station(struct station *s, int level, unsigned protections, bool acknowledge)
{
    if (level >= 0 && level < 100) {
        s->wanted = 0;
    } else if (level < 0 || level >= 800) {
        s->wanted = 3;
    } else if (level >= 600) {
        s->wanted = 2;
    } else if (level >= 350) {
        s->wanted = 1;
    }
    int on = 0;
    for (int i = 0; i < 3; i++) {
        s->pumps[i].request &= !s->pumps[i].fault;
        on += s->pumps[i].request;
    }
    if (on > s->wanted) {
        struct pump *best = NULL;
        uint32_t most = 0;
        for (int i = 0; i < 3; i++) {
            struct pump *p = &s->pumps[i];
            if (p->request && p->hours >= most) {
                best = p;
                most = p->hours;
            }
        }
        if (best != NULL) {
            best->request = false;
        }
    } else if (on < s->wanted) {
        struct pump *best = NULL;
        uint32_t least = UINT32_MAX;
        for (int i = 0; i < 3; i++) {
            struct pump *p = &s->pumps[i];
            if (!p->request && !p->fault && p->hours < least) {
                best = p;
                least = p->hours;
            }
        }
        if (best != NULL) {
            best->request = true;
        }
    }
    s->running = s->faults = s->services = 0;
    s->power = 0;
    for (int i = 0; i < 3; i++) {
        struct pump *p = &s->pumps[i];
        run_pump(p, protections >> (i + 1) & 1, acknowledge, 7.5f);
        s->running += p->running;
        s->faults += p->fault;
        s->services += p->service;
        s->power += p->power;
    }
}

static int level(unsigned at, unsigned random)
{
    int level = (int16_t)((int16_t)(rdint(M + at) * 7 + (int)(random & 0x3FF)) / 8);
    wr16(M + at, (uint16_t)level);
    return level;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    int north = level(10, rd16(M + 4)), south = level(12, rd16(M + 6)), west = level(14, rd16(M + 5));
    run_station(&stations[0], north, M[4] & M[5], bit(M, 7, 0));
    run_station(&stations[1], south, M[5] & M[6], bit(M, 7, 1));
    run_station(&stations[2], west, M[4] & M[6], bit(M, 7, 2));
    const struct station *a = &stations[0], *b = &stations[1], *c = &stations[2];
    wr16(result + RUNNING, (uint16_t)(a->running + b->running + c->running));
    wr16(result + FAULTS, (uint16_t)(a->faults + b->faults + c->faults));
    wr16(result + SERVICES, (uint16_t)(a->services + b->services + c->services));
    wrreal(result + POWER, a->power + b->power + c->power);
    const struct pump *first = &a->pumps[0];
    wr32(result + FIRST, first->hours);
    wr16(result + FIRST + 4, first->starts);
    wrreal(result + FIRST + 6, first->power);
    result[FIRST + 10] = (uint8_t)(first->running | first->fault << 1 | first->service << 2);
}
