//! The functions that generated code calls: by linker symbol, by address, or by number.
//!
//! One table defines all three forms. None of them may panic: a panic must not reach generated code.

use plcc_abi::RuntimeFn;
use plcc_abi::functions::TimerMode;
use plcc_abi::text::{BR, Rules, WRITTEN};

use crate::cpu::Cpu;
use crate::probe::Registers;
use crate::system::numbers;
use crate::text::way::{Short, Way};
use crate::text::{Texts, decimal, join, search};
use crate::{math, s7200, text, timers};

/// The result of a function of texts: BR.
fn flag(good: bool) -> u64 {
    if good { BR } else { 0 }
}

/// What a body gives that may give up by `?`.
#[inline(always)]
fn tried(body: impl FnOnce() -> Option<u64>) -> Option<u64> {
    body()
}

/// A value as it crosses the border, from and to the bits that an interpreter holds.
trait Border {
    fn from_bits(bits: u64) -> Self;
    fn to_bits(self) -> u64;
}

impl Border for u32 {
    fn from_bits(bits: u64) -> u32 {
        bits as u32
    }
    fn to_bits(self) -> u64 {
        u64::from(self)
    }
}

impl Border for u64 {
    fn from_bits(bits: u64) -> u64 {
        bits
    }
    fn to_bits(self) -> u64 {
        self
    }
}

impl Border for f32 {
    fn from_bits(bits: u64) -> f32 {
        f32::from_bits(bits as u32)
    }
    fn to_bits(self) -> u64 {
        u64::from(f32::to_bits(self))
    }
}

impl Border for f64 {
    fn from_bits(bits: u64) -> f64 {
        f64::from_bits(bits)
    }
    fn to_bits(self) -> u64 {
        f64::to_bits(self)
    }
}

impl Border for () {
    fn from_bits(_: u64) {}
    fn to_bits(self) -> u64 {
        0
    }
}

/// Runs `body` with text operands, by their places among the operands, in place of their offsets, and with the [`Way`](crate::text::way::Way)
/// to memory as `m`. `others` are the other values that the body uses. `?` in the body gives the short way up.
macro_rules! with_texts {
    ($cpu:ident, $known:ident, $m:ident, [$($text:ident $index:literal),*], [$($other:ident),*], $body:expr) => {{
        // The body twice: where all is as declared, the operands need not be looked at again, and no register is saved for that.
        #[cold]
        #[inline(never)]
        #[allow(clippy::too_many_arguments, reason = "those of the function")]
        fn look_again($cpu: &Cpu, $known: u64, $($text: u32,)* $($other: u32),*) -> u64 {
            let texts = Texts::new(&$cpu.memory, $known);
            let $m = texts.bytes();
            $(let $text = texts.other($index, $text);)*
            tried(|| Some($body)).unwrap_or(0)
        }
        let texts = Texts::new(&$cpu.memory, $known);
        if $(!texts.is_as_declared($index, $text))||* {
            return look_again($cpu, $known, $($text,)* $($other),*);
        }
        let done = tried(|| {
            let $m = Short(texts.bytes());
            $(let $text = Some(texts.as_declared($index, $text));)*
            Some($body)
        });
        match done {
            Some(done) => done,
            None => look_again($cpu, $known, $($text,)* $($other),*),
        }
    }};
}

/// The type of a parameter, if the table does not say it.
macro_rules! param_type {
    () => {
        u32
    };
    ($type:ty) => {
        $type
    };
}

macro_rules! functions {
    (
        memory { $( $name:ident = $symbol:ident ( $cpu:ident $(, $param:ident $(: $mtype:ty)? )* ) $(-> $result:ty)? $body:block )* }
        pure { $( $pname:ident = $psymbol:ident ( $( $pparam:ident : $ptype:ty ),* ) -> $presult:ty $pbody:block )* }
    ) => {
        $(
            /// See the row of the same name in `plcc_abi::functions`.
            ///
            /// # Safety
            /// `mem` is the base of the memory of a living `Cpu`.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $symbol(mem: *mut u8 $(, $param: param_type!($($mtype)?))*) $(-> $result)? {
                // SAFETY: the caller's promise.
                let $cpu = unsafe { Cpu::of(mem) };
                $body
            }
        )*
        $(
            /// See the row of the same name in `plcc_abi::functions`.
            #[unsafe(no_mangle)]
            pub extern "C" fn $psymbol($( $pparam: $ptype ),*) -> $presult $pbody
        )*

        /// Address of a runtime function, for code made in memory.
        pub fn address(function: RuntimeFn) -> *const u8 {
            match function {
                $( RuntimeFn::$name => $symbol as *const u8, )*
                $( RuntimeFn::$pname => $psymbol as *const u8, )*
            }
        }

        /// Calls a runtime function with arguments as bits, zero-extended; a missing argument is 0. The result is
        /// zero-extended too, 0 if there is none. `mem` is what [`Code::call`](crate::Code::call) was given; pure
        /// functions ignore it.
        #[allow(clippy::not_unsafe_ptr_arg_deref)] // An interpreter passes on what the runtime gave it.
        pub fn call(function: RuntimeFn, mem: *mut u8, args: &[u64]) -> u64 {
            let mut args = args.iter().copied();
            match function {
                $( RuntimeFn::$name => {
                    $( let $param: param_type!($($mtype)?) = Border::from_bits(args.next().unwrap_or(0)); )*
                    // SAFETY: `mem` is the base of a living `Cpu`, see above.
                    Border::to_bits(unsafe { $symbol(mem $(, $param)*) })
                } )*
                $( RuntimeFn::$pname => {
                    $( let $pparam: $ptype = Border::from_bits(args.next().unwrap_or(0)); )*
                    Border::to_bits($psymbol($($pparam),*))
                } )*
            }
        }
    };
}

functions! {
    memory {
        Safepoint = plcc_rt_safepoint(cpu, site) -> u32 { cpu.safepoint(site) }
        SyncError = plcc_rt_sync_error(cpu, site, code, access, info) -> u32 {
            cpu.sync_error(site, code as u8, access, info)
        }
        Stop = plcc_rt_stop(cpu, site, code) { cpu.stop_by(code as u16, site, 0) }
        CallBlock = plcc_rt_call_block(cpu, site, kind, number, lbase, vbase) -> u32 {
            cpu.call_block(site, kind, number, lbase, vbase)
        }
        SystemFunction = plcc_rt_system_function(cpu, site, number, block, lbase) -> u32 {
            cpu.system_function(site, number, block, lbase)
        }
        TimeTck = plcc_rt_time_tck(cpu) -> u32 { cpu.clock.ticks() }
        TimerStart = plcc_rt_timer_start(cpu, number, mode, value, rlo) {
            if let Some(mode) = TimerMode::ALL.get(mode as usize) {
                timers::start(&cpu.memory, &cpu.clock, number, *mode, value, rlo != 0);
            }
        }
        TimerSettle = plcc_rt_timer_settle(cpu, number) { timers::settle(&cpu.memory, &cpu.clock, number) }
        PeripheralRead = plcc_rt_peripheral_read(cpu, address, bytes) -> u64 { cpu.peripheral_read(address, bytes) }
        LocalError = plcc_rt_local_error(cpu, site, code, access, info, lbase) -> u32 {
            cpu.local_error(site, code as u8, access, info, lbase)
        }
        PeripheralWriteBit = plcc_rt_peripheral_write_bit(cpu, address, bit, value) -> u32 {
            cpu.peripheral_write_bit(address, bit, value != 0).into()
        }
        PeripheralWrite = plcc_rt_peripheral_write(cpu, address, bytes, value) -> u32 {
            cpu.peripheral_write(address, bytes, value).into()
        }
        Assert = plcc_rt_assert(cpu, id, comparison, left, right) {
            cpu.assertions.check(cpu, id as usize, comparison as usize, left.into(), right.into());
        }
        AssertLong = plcc_rt_assert_long(cpu, id, comparison, left, left_high, right, right_high) {
            let (left, right) = (u64::from(left_high) << 32 | u64::from(left), u64::from(right_high) << 32 | u64::from(right));
            cpu.assertions.check(cpu, id as usize, comparison as usize, left, right);
        }
        AssertMemory = plcc_rt_assert_memory(cpu, id, comparison, left, left_high, right, right_high) {
            let (left, right) = (u64::from(left_high) << 32 | u64::from(left), u64::from(right_high) << 32 | u64::from(right));
            cpu.assertions.check(cpu, id as usize, comparison as usize, left, right);
        }
        ProbeEnter = plcc_rt_probe_enter(cpu, place, instance) {
            cpu.tell(|watcher| watcher.enter(cpu, place, instance));
            cpu.monitor.enter(cpu, place, instance);
        }
        ProbeLeave = plcc_rt_probe_leave(cpu, place) {
            cpu.tell(|watcher| watcher.leave(cpu, place));
            cpu.monitor.leave(cpu);
        }
        ProbeRegisters = plcc_rt_probe_registers(cpu, place, status, accu1, accu2, ar1, ar2, dbs) {
            let registers = Registers { status, accu: [accu1, accu2], ar: [ar1, ar2], db: dbs as u16, di: (dbs >> 16) as u16 };
            cpu.tell(|watcher| watcher.registers(cpu, place, registers));
            cpu.monitor.registers(cpu, place, registers);
        }
        ProbeValue = plcc_rt_probe_value(cpu, place, value: u64) {
            cpu.tell(|watcher| watcher.value(cpu, place, value));
            cpu.monitor.value(cpu, place, value);
        }
        CopyText = plcc_rt_copy_text(cpu, to, from, limit, wide) -> u32 {
            text::copy(&cpu.memory, to, from, limit, wide != 0).into()
        }
        TextConcat = plcc_rt_text_concat(cpu, known: u64, in1, in2, out) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1, out 2], [], flag(join::concat(m, in1, in2, out)?))
        }
        TextConcatThree = plcc_rt_text_concat_three(cpu, known: u64, in1, in2, in3, out) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1, in3 2, out 3], [], {
                let (first, good) = join::concat_three(m, [in1, in2, in3], out)?;
                flag(good) | if first { WRITTEN } else { 0 }
            })
        }
        TextCompare = plcc_rt_text_compare(cpu, known: u64, in1, in2, relation) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1], [relation], {
                search::relation(m.bytes(), in1, in2, relation).map_or(0, |holds| BR | u64::from(holds))
            })
        }
        TextFind = plcc_rt_text_find(cpu, known: u64, in1, in2, rules) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1], [rules], {
                let (position, good) = search::find(m.bytes(), in1, in2, Rules::of(rules as u16));
                flag(good) | u64::from(position)
            })
        }
        TextLength = plcc_rt_text_length(cpu, known: u64, text, maximum) -> u64 {
            with_texts!(cpu, known, _m, [text 0], [maximum], BR | u64::from(text::length(text, maximum != 0)))
        }
        TextReplace = plcc_rt_text_replace(cpu, known: u64, in1, in2, l, p, rules, out) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1, out 2], [l, p, rules], {
                flag(join::replace(m, in1, in2, [l as i16, p as i16], Rules::of(rules as u16), out)?)
            })
        }
        TextLeft = plcc_rt_text_left(cpu, known: u64, text, l, rules, out) -> u64 {
            with_texts!(cpu, known, m, [text 0, out 1], [l, rules], flag(join::left(m, text, l as i16, Rules::of(rules as u16), out)?))
        }
        TextRight = plcc_rt_text_right(cpu, known: u64, text, l, rules, out) -> u64 {
            with_texts!(cpu, known, m, [text 0, out 1], [l, rules], flag(join::right(m, text, l as i16, Rules::of(rules as u16), out)?))
        }
        TextMid = plcc_rt_text_mid(cpu, known: u64, text, l, p, out) -> u64 {
            with_texts!(cpu, known, m, [text 0, out 1], [l, p], flag(join::mid(m, text, l as i16, p as i16, out)?))
        }
        TextDelete = plcc_rt_text_delete(cpu, known: u64, text, l, p, rules, out) -> u64 {
            with_texts!(cpu, known, m, [text 0, out 1], [l, p, rules], {
                flag(join::delete(m, text, l as i16, p as i16, Rules::of(rules as u16), out)?)
            })
        }
        TextInsert = plcc_rt_text_insert(cpu, known: u64, in1, in2, p, rules, out) -> u64 {
            with_texts!(cpu, known, m, [in1 0, in2 1, out 2], [p, rules], {
                flag(join::insert(m, in1, in2, p as i16, Rules::of(rules as u16), out)?)
            })
        }
        TextOfDint = plcc_rt_text_of_dint(cpu, known: u64, value, form, out) -> u64 {
            with_texts!(cpu, known, m, [out 0], [value, form], flag(decimal::write(m.bytes(), value as i32, form as u16, out)))
        }
        TextOfReal = plcc_rt_text_of_real(cpu, known: u64, value, out) -> u64 {
            with_texts!(cpu, known, m, [out 0], [value], flag(numbers::write_real(m.bytes(), f32::from_bits(value), out)))
        }
        TextFixedOfReal = plcc_rt_text_fixed_of_real(cpu, known: u64, value, out) -> u64 {
            with_texts!(cpu, known, m, [out 0], [value], flag(numbers::write_fixed_real(m.bytes(), f32::from_bits(value), out)))
        }
        TextToDint = plcc_rt_text_to_dint(cpu, known: u64, text, longest, low, high) -> u64 {
            with_texts!(cpu, known, m, [text 0], [longest, low, high], {
                let read = decimal::read(m.bytes(), text, longest as u16, low as i32, high as i32);
                read.map_or(0, |(value, good)| WRITTEN | flag(good) | u64::from(value as u32))
            })
        }
        TextScan = plcc_rt_text_scan(cpu, known: u64, text, kind) -> u64 {
            with_texts!(cpu, known, m, [text 0], [kind], {
                let (value, length) = numbers::scan_start(&m, text, kind as u16)?;
                flag(length != 0) | u64::from(value as u32)
            })
        }
        TextToReal = plcc_rt_text_to_real(cpu, known: u64, text) -> u64 {
            with_texts!(cpu, known, m, [text 0], [], {
                let read = numbers::read_real(m.bytes(), text);
                read.map_or(0, |(value, good)| WRITTEN | flag(good) | u64::from(value.to_bits()))
            })
        }
        TextScanReal = plcc_rt_text_scan_real(cpu, known: u64, text) -> u64 {
            with_texts!(cpu, known, m, [text 0], [], {
                let (value, length) = numbers::real_start(m.bytes(), text);
                flag(length != 0) | u64::from(value.to_bits())
            })
        }
        S7200Operation = plcc_rt_s7200_operation(cpu, site, operation, a, b, c, d) -> u64 {
            cpu.s7200_operation(operation, &s7200::Operands { site, a, b, c, d })
        }
        S7200Timer = plcc_rt_s7200_timer(cpu, number, kind, preset, enable) {
            cpu.s7200_timer(number, kind, preset as u16 as i16, enable != 0)
        }
        S7200TimerSync = plcc_rt_s7200_timer_sync(cpu, number) { cpu.s7200_timer_sync(number) }
        S7200Pointer = plcc_rt_s7200_pointer(cpu, pointer, bytes, write) -> u32 {
            cpu.s7200_pointer(pointer, bytes, write != 0)
        }
        S7200Error = plcc_rt_s7200_error(cpu, site, code) { cpu.s7200_error(site, code as u16) }
        S7200Counter = plcc_rt_s7200_counter(cpu, number) -> u32 { cpu.s7200_counter(number) }
        S7200Milliseconds = plcc_rt_s7200_milliseconds(cpu) -> u32 {
            (cpu.clock.now() / crate::clock::NS_PER_MS) as u32
        }
        S7200SpecialWritten = plcc_rt_s7200_special_written(cpu, byte) { cpu.s7200_special_written(byte) }
        Sleep = plcc_rt_sleep(cpu, ms) -> u32 { cpu.pass_time(u64::from(ms) * crate::clock::NS_PER_MS, false) }
    }
    pure {
        Sin = plcc_rt_sin(x: f32) -> f32 { math::sin(x) }
        Cos = plcc_rt_cos(x: f32) -> f32 { math::cos(x) }
        Tan = plcc_rt_tan(x: f32) -> f32 { math::tan(x) }
        Asin = plcc_rt_asin(x: f32) -> f32 { math::asin(x) }
        Acos = plcc_rt_acos(x: f32) -> f32 { math::acos(x) }
        Atan = plcc_rt_atan(x: f32) -> f32 { math::atan(x) }
        Exp = plcc_rt_exp(x: f32) -> f32 { math::exp(x) }
        Ln = plcc_rt_ln(x: f32) -> f32 { math::ln(x) }
        Log = plcc_rt_log(x: f32) -> f32 { math::log(x) }
        Pow = plcc_rt_pow(x: f32, y: f32) -> f32 { math::pow(x, y) }
        SinLong = plcc_rt_sin_long(x: f64) -> f64 { math::long(x.sin()) }
        CosLong = plcc_rt_cos_long(x: f64) -> f64 { math::long(x.cos()) }
        TanLong = plcc_rt_tan_long(x: f64) -> f64 { math::long(x.tan()) }
        AsinLong = plcc_rt_asin_long(x: f64) -> f64 { math::long(x.asin()) }
        AcosLong = plcc_rt_acos_long(x: f64) -> f64 { math::long(x.acos()) }
        AtanLong = plcc_rt_atan_long(x: f64) -> f64 { math::long(x.atan()) }
        ExpLong = plcc_rt_exp_long(x: f64) -> f64 { math::long(x.exp()) }
        LnLong = plcc_rt_ln_long(x: f64) -> f64 { math::ln_long(x) }
        LogLong = plcc_rt_log_long(x: f64) -> f64 { math::log_long(x) }
        PowLong = plcc_rt_pow_long(x: f64, y: f64) -> f64 { math::pow_long(x, y) }
    }
}
