"""Many stations on one machine, without containers: many.py EXECUTABLE [STATIONS [KILLED [CYCLE]]]

Starts the stations, each in a folder of its own, with one mosquitto for all; kills some of them and starts them again; compares what each
has counted before and after; shows the times from cycle to cycle and the memory of a station. Needs mosquitto and mosquitto_sub (Debian: mosquitto-clients)."""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request
from concurrent.futures import ThreadPoolExecutor

BROKER, FIRST = 18830, 20000


def main(executable, stations=1000, killed=100, cycle='100ms'):
    stations, killed = int(stations), int(killed)
    with tempfile.TemporaryDirectory() as folder:
        configuration = os.path.join(folder, 'mosquitto.conf')
        with open(configuration, 'w') as file:
            file.write(f'listener {BROKER} 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\n')
        broker = subprocess.Popen(['mosquitto', '-c', configuration], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        fleet = {}
        try:
            time.sleep(0.5)
            executable = os.path.abspath(executable)
            for number in range(stations):
                os.mkdir(os.path.join(folder, str(number)))
                fleet[number] = start(executable, folder, number, cycle)
            before = settled(stations, lambda values: len(values) == stations)
            chosen = random.Random(1).sample(range(stations), killed)
            for number in chosen:
                fleet[number].kill()
                fleet[number].wait()
            seen = published(stations)
            for number in chosen:
                fleet[number] = start(executable, folder, number, cycle)
            began = time.monotonic()
            is_back = lambda number, values: values[number]['starts'] > before[number]['starts']
            after = settled(stations, lambda values: all(is_back(number, values) for number in chosen))
            print(f'all are back after {time.monotonic() - began:.0f} s')
            print(f'{len(after)} stations publish to one broker, {killed} were killed')
            lost = [number for number in range(stations) if after[number]['parts'] < seen[number]['parts']]
            starts = [number for number in chosen if after[number]['starts'] != before[number]['starts'] + 1]
            print(f'went back: {len(lost)}; killed without a new start: {len(starts)}')
            print(f'memory of a station: {memory(fleet.values()):.0f} kB')
            histogram(stations)
            assert not lost and not starts
        finally:
            for process in fleet.values():
                process.send_signal(signal.SIGTERM)
            for process in fleet.values():
                process.wait()
            broker.terminate()
            broker.wait()


def start(executable, folder, number, cycle):
    flags = ['--quiet', '--cycle-time', cycle, '--retain', 'retain', '--metrics', str(FIRST + number),
             '--mqtt', f'mqtt://127.0.0.1:{BROKER}/plant/{number}']
    return subprocess.Popen([executable, *flags], cwd=os.path.join(folder, str(number)), stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def settled(stations, holds, longest=180):
    """What is published as soon as that holds, at the latest after so many seconds."""
    until = time.monotonic() + longest
    while True:
        time.sleep(5)
        values = published(stations)
        if holds(values) or time.monotonic() > until:
            return values


def published(stations):
    """What the broker has of each station: all values are retained."""
    flags = ['-p', str(BROKER), '-t', 'plant/+/value/#', '-v', '-C', str(2 * stations), '-W', '60']
    lines = subprocess.run(['mosquitto_sub', *flags], capture_output=True, text=True).stdout.splitlines()
    values = {}
    for line in lines:
        topic, value = line.split(' ', 1)
        _, number, _, name = topic.split('/')
        values.setdefault(int(number), {})[name.split('.')[-1]] = json.loads(value)['value']
    return values


def memory(processes):
    """Of the machine, in kB: what processes share counts in parts."""
    total = 0
    for process in processes:
        with open(f'/proc/{process.pid}/smaps_rollup') as file:
            total += next(int(line.split()[1]) for line in file if line.startswith('Pss:'))
    return total / len(processes)


def histogram(stations):
    buckets = {}

    def page(number):
        return urllib.request.urlopen(f'http://127.0.0.1:{FIRST + number}/metrics', timeout=60).read().decode()

    # A station answers between two cycles.
    with ThreadPoolExecutor(50) as threads:
        pages = list(threads.map(page, range(stations)))
    for page in pages:
        for line in page.splitlines():
            if line.startswith('plc_cycle_seconds_bucket'):
                limit = line.split('le="')[1].split('"')[0]
                buckets[limit] = buckets.get(limit, 0) + int(float(line.split()[-1]))
    before = 0
    for limit, count in buckets.items():
        if count > before:
            print(f'cycle to cycle up to {limit} s: {count - before}')
        before = count


main(*sys.argv[1:])
