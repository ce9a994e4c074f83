"""Checks units with FMPy, a simulator that knows nothing of plcc: check.py types|trace|coupled FILE..."""

import csv
import sys

import numpy as np
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu


class Unit:
    """An instance of a unit, whose variables have names."""

    def __init__(self, path):
        problems = validate_fmu(path)
        assert not problems, problems
        self.description = read_model_description(path)
        self.version = self.description.fmiVersion[0]
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages = []
        self.instance = instantiate_fmu(extract(path), self.description, fmi_type='CoSimulation')

    def start(self, values={}):
        for name, value in values.items():
            self.set(name, value)
        if self.version == '2':
            self.instance.setupExperiment(startTime=0.0)
        self.instance.enterInitializationMode()
        self.instance.exitInitializationMode()

    def get(self, name):
        variable = self.variables[name]
        value = getattr(self.instance, 'get' + variable.type)([variable.valueReference])[0]
        return value.decode() if isinstance(value, bytes) else value

    def set(self, name, value):
        variable = self.variables[name]
        getattr(self.instance, 'set' + variable.type)([variable.valueReference], [value])

    def step(self, time, length):
        self.instance.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def end(self):
        self.instance.terminate()
        self.instance.freeInstance()


# Name, type in version 2.0, type in version 3.0, start value, another value.
TYPES = [
    ('b', 'Boolean', 'Boolean', True, False),
    ('by', 'Integer', 'UInt8', 0x12, 0xFF),
    ('w', 'Integer', 'UInt16', 0xFFFF, 0x8000),
    ('dw', 'Real', 'UInt32', 0xF0000001, 0xFFFFFFFF),
    ('lw', 'String', 'UInt64', 0xF000000000000001, 0xFFFFFFFFFFFFFFFF),
    ('si', 'Integer', 'Int8', -5, -128),
    ('i', 'Integer', 'Int16', -300, 32767),
    ('di', 'Integer', 'Int32', -70000, -2147483648),
    ('li', 'String', 'Int64', -5000000000, -9223372036854775808),
    ('us', 'Integer', 'UInt8', 250, 255),
    ('ui', 'Integer', 'UInt16', 60000, 65535),
    ('ud', 'Real', 'UInt32', 4000000000, 4294967295),
    ('ul', 'String', 'UInt64', 18446744073709551615, 18446744073709551614),
    ('r', 'Real', 'Float32', float(np.float32(0.1)), -2.5),
    ('lr', 'Real', 'Float64', 0.1, 1e300),
    ('t', 'Real', 'Float64', 1.5, -0.25),
    ('lt', 'Real', 'Float64', 1.0005, 0.000000001),
    ('d', 'String', 'String', 'D#2026-01-31', 'D#1990-01-01'),
    ('tod', 'String', 'String', 'TOD#12:30:15.5', 'TOD#23:59:59.999'),
    ('c', 'String', 'String', 'x', "'"),
    ('st', 'Real', 'Float64', 2.5, 9990.0),
    ('dt', 'String', 'String', 'DT#2026-01-31-06:00:00.5', 'DT#1990-01-01-00:00:00'),
    ('ldt', 'String', 'String', 'LDT#2026-01-31-06:00:00.000000001', 'LDT#1970-01-01-00:00:00'),
    ('ltod', 'String', 'String', 'LTOD#06:00:00.000000001', 'LTOD#23:59:59.999999999'),
    ('dtl', 'String', 'String', 'DTL#1970-01-01-00:00:00', 'DTL#2262-04-11-23:47:16'),
    ('wc', 'String', 'String', 'y', 'Ж'),
    ('ws', 'String', 'String', 'wide', 'Жук $0416'),
    ('s', 'String', 'String', 'start <1> & "2"', "it's $5, $41"),
]


def types(path):
    unit, second = Unit(path), Unit(path)
    convert = lambda ty, value: str(value) if ty == 'String' else value
    for name, v2, v3, start, _ in TYPES:
        ty = v2 if unit.version == '2' else v3
        variable = unit.variables['V.' + name]
        assert variable.type == ty, (name, variable.type)
        assert variable.causality == 'local' and variable.initial == 'exact', name
        assert unit.get('V.' + name) == convert(ty, start), (name, unit.get('V.' + name))
        written = variable.start
        if ty == 'Boolean':
            written = {'true': True, 'false': False}[written]
        elif ty.startswith(('Int', 'UInt')):
            written = int(written)
        elif ty.startswith(('Real', 'Float')):
            written = float(np.float32(written)) if name == 'r' else float(written)
        assert written == convert(ty, start), (name, written)
    assert unit.variables['V.t'].unit == 's'
    # Half of the values before the start, half of them later.
    other = {'V.' + name: convert(unit.variables['V.' + name].type, value) for name, _, _, _, value in TYPES}
    names = list(other)
    unit.start({name: other[name] for name in names[::2]})
    second.start()
    unit.step(0.0, 0.01)
    for name in names[1::2]:
        unit.set(name, other[name])
    unit.step(0.01, 0.01)
    second.step(0.0, 0.02)
    for name, _, _, start, _ in TYPES:
        copy = 'Copy.' + name
        assert unit.get(copy) == other['V.' + name], (copy, unit.get(copy))
        assert second.get(copy) == convert(second.variables[copy].type, start), (copy, second.get(copy))
    assert unit.get('Copy.cycles') == 2 and second.get('Copy.cycles') == 2
    # Inputs, outputs.
    assert unit.variables['I0.0'].causality == 'input' and unit.variables['Q0.0'].causality == 'output'
    unit.set('I0.0', True)
    unit.set('IW2', 0xABCD)
    unit.step(0.02, 0.01)
    assert unit.get('Q0.0') and unit.get('QW2') == 0xABCD and not second.get('Q0.0')
    # What is not possible is refused, and the instance goes on.
    refused(lambda: unit.set('Q0.0', True))
    refused(lambda: unit.step(5.0, 0.01))
    if unit.version == '2':
        refused(lambda: unit.set('V.i', 32768))
        refused(lambda: unit.set('V.lw', 'many'))
        refused(lambda: unit.set('V.ud', 0.5))
        refused(lambda: unit.set('V.r', 1e39))
    refused(lambda: unit.set('V.s', 'more than twenty characters'))
    refused(lambda: unit.instance.getString([unit.variables['I0.0'].valueReference]))
    unit.step(0.03, 0.01)
    assert unit.get('Copy.cycles') == 4
    # Reset: the start values again.
    unit.instance.terminate()
    unit.instance.reset()
    unit.start()
    unit.step(0.0, 0.01)
    assert unit.get('Copy.cycles') == 1 and unit.get('Copy.i') == -300 and not unit.get('I0.0')
    unit.end()
    second.end()
    # And by the simulator alone.
    table = np.array([(0.0, False, 0), (0.1, True, 7), (0.2, True, 9)], dtype=[('time', 'f8'), ('I0.0', '?'), ('IW2', 'i4')])
    result = simulate_fmu(path, stop_time=0.3, output_interval=0.01, input=table, output=['Q0.0', 'QW2', 'plcc.running'])
    # The third cycle begins at 0.02 s. A step sees the inputs at its start.
    by_time = {round(float(row['time']), 2): row for row in result}
    assert not by_time[0.1]['Q0.0'] and by_time[0.11]['Q0.0'], by_time
    assert by_time[0.11]['QW2'] == 7 and by_time[0.3]['QW2'] == 9 and by_time[0.3]['plcc.running']


def refused(act):
    try:
        act()
    except Exception:
        return
    raise AssertionError('not refused')


def trace(path, inputs, expected):
    """The same values after each cycle as in the program's own trace, whatever the steps."""
    rows = list(csv.DictReader(open(expected)))
    changes = {float(row['time']): row for row in csv.DictReader(open(inputs))}
    columns = [name for name in rows[0] if name not in ('cycle', 'time_ms')]
    for steps in ([0.01], [0.005, 0.005], [0.0025, 0.0075], [0.001, 0.002, 0.007]):
        unit = Unit(path)
        unit.start()
        for number in (float('nan'), float('inf')):
            refused(lambda: unit.set('AI0', number))
        time = cycle = 0
        for row in rows[1:]:
            change = changes.get(round(cycle * 0.01, 2), {})
            for name, value in change.items():
                if name != 'time':
                    ty = unit.variables[name].type
                    unit.set(name, value == '1' if ty == 'Boolean' else float(value))
            for length in steps:
                unit.step(time, length)
                time += length
            cycle += 1
            for name in columns:
                # As the trace has it after the cycle, before time passes. `AO0 in mA`, `Level as REAL`: the name comes first.
                value, text = unit.get(name.split(' in ')[0].split(' as ')[0]), row[name]
                same = float(text) == value if '#' not in text else int(text.split('#')[1], 16) == value
                if isinstance(value, float) and '#' not in text:
                    same = abs(float(text) - value) <= 1e-5 * abs(value)
                assert same, (steps, cycle, name, value, text)
        assert cycle > 100
        unit.end()


def coupled(pump_path, gate_path):
    """Two PLCs and a tank: the pump fills it, it drains, the gate permits."""

    def run():
        pump, gate = Unit(pump_path), Unit(gate_path)
        pump.start()
        gate.start()
        level, levels, step = 50.0, [], 0.01
        for number in range(6000):
            time = number * step
            pump.set('I0.0', gate.get('Q0.0'))
            pump.set('IW2', int(level * 10))
            gate.set('I0.0', pump.get('Q0.0'))
            pump.step(time, step)
            gate.step(time, step)
            inflow = 40.0 if pump.get('Q0.0') else 0.0
            level = min(100.0, max(0.0, level + (inflow - 15.0) * step))
            levels.append(level)
        result = (pump.get('MW0'), gate.get('MW0'), levels)
        pump.end()
        gate.end()
        return result

    starts, seen, levels = run()
    # The gate sees a start one step later; both have counted the same.
    assert starts == seen and starts >= 5, (starts, seen)
    assert min(levels) >= 0.0 and max(levels) < 81.0, (min(levels), max(levels))
    # The gate withholds the pump after each third start: the level falls for a second while it would rise.
    assert any(20.5 < before < 79.5 and after < before < earlier for earlier, before, after in
               zip(levels, levels[1:], levels[2:]))
    assert run() == (starts, seen, levels), 'another result the second time'


{'types': types, 'trace': trace, 'coupled': coupled}[sys.argv[1]](*sys.argv[2:])
print('ok')
