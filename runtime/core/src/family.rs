//! What differs between the families of CPUs at run time. Each family implements [`Family`]; `Cpu::new` chooses one.

use plcc_abi::image;

use crate::cpu::{Area, Cpu};
use crate::cycle::{Course, CycleTimes, Observer};
use crate::events::StartInfo;
use crate::schedule::NEVER;

/// The hooks of startup, cycle and interrupts. They are called in this order.
pub(crate) trait Family {
    /// Cycles in which only the program takes part, as [`Cpu::go_through`] with this family: its hooks are part of the loop.
    fn go_on_alone(&self, cpu: &Cpu, course: &mut Course, observer: &mut dyn Observer, is_wanted: &dyn Fn() -> bool);

    /// The CPU is switched on. Its inputs have no values yet.
    fn power_on(&self, _cpu: &Cpu) {}

    /// Makes the process image of inputs as startup OBs see it after a warm or cold restart.
    fn clear_inputs(&self, _cpu: &Cpu) {}

    /// The start information of a startup OB with what this family tells in it.
    fn startup_info(&self, _cpu: &Cpu, info: StartInfo, _automatic: bool) -> StartInfo {
        info
    }

    /// RUN begins, and the inputs have their first values.
    fn start_hardware(&self, _cpu: &Cpu) {}

    /// A cycle begins; its inputs are in the process image.
    fn begin_cycle(&self, _cpu: &Cpu, _cycle: u64, _times: &CycleTimes) {}

    /// Runs the program once.
    fn run_program(&self, cpu: &Cpu, cycle: u64, times: &CycleTimes);

    /// The program has run, or the CPU has stopped in it.
    fn end_program(&self, _cpu: &Cpu) {}

    /// Copies the process image of outputs to the modules.
    fn write_outputs(&self, cpu: &Cpu);

    /// The CPU has stopped, and the driver has been told to stop.
    fn stop_outputs(&self, _cpu: &Cpu) {}

    /// The run ends, in STOP or because the last cycle has ended.
    fn finish(&self, _cpu: &Cpu) {}

    /// When an event that only this family has is next due.
    fn next_due(&self, _cpu: &Cpu) -> u64 {
        NEVER
    }

    /// True while nothing can happen but at the times of [`next_due`](Family::next_due).
    fn is_timed_only(&self, _cpu: &Cpu) -> bool {
        true
    }

    /// Handles the events that only this family has and that are due now.
    fn poll(&self, _cpu: &Cpu) {}

    /// Runs the waiting interrupts that may run now.
    fn dispatch(&self, cpu: &Cpu);

    /// True while generated code must leave its blocks although the CPU is in RUN.
    fn is_leaving(&self, _cpu: &Cpu) -> bool {
        false
    }

    /// The cycle has taken `ms` milliseconds, more than allowed. This was found at `site`.
    fn cycle_too_long(&self, cpu: &Cpu, ms: u32, site: u32);

    /// The program is in an endless loop at `site`, under the virtual clock.
    fn hang(&self, cpu: &Cpu, site: u32);

    /// The program is about to read a peripheral input.
    fn before_input(&self, _cpu: &Cpu) {}

    /// The program has written a peripheral output.
    fn output_written(&self, _cpu: &Cpu, _address: u32, _bytes: u32, _value: u32) {}
}

/// S7-300/400 and S7-1200/1500: organization blocks with priorities.
pub(crate) struct Step7;

impl Family for Step7 {
    fn go_on_alone(&self, cpu: &Cpu, course: &mut Course, observer: &mut dyn Observer, is_wanted: &dyn Fn() -> bool) {
        cpu.go_through::<Step7, true>(self, course, observer, is_wanted);
    }

    fn power_on(&self, cpu: &Cpu) {
        cpu.power_on_retentive();
    }

    /// Inputs are read after the startup OBs. Source: S7-1200 system manual, tasks in STARTUP; Programming with STEP 7, startup.
    fn clear_inputs(&self, cpu: &Cpu) {
        let (base, length) = cpu.area(Area::Inputs);
        cpu.memory.load(base, &vec![0; length as usize]);
    }

    fn startup_info(&self, cpu: &Cpu, info: StartInfo, automatic: bool) -> StartInfo {
        match cpu.image.profile.family {
            image::Family::S71200 | image::Family::S71500 => cpu.startup_info_of_portal(info),
            image::Family::S7300 | image::Family::S7400 | image::Family::S7200 => {
                cpu.startup_info_of_step7(info, automatic)
            }
        }
    }

    fn run_program(&self, cpu: &Cpu, cycle: u64, times: &CycleTimes) {
        cpu.run_program_cycle(cycle, times);
    }

    fn write_outputs(&self, cpu: &Cpu) {
        cpu.write_output_image();
    }

    fn dispatch(&self, cpu: &Cpu) {
        if !cpu.schedule.is_queue_empty() {
            cpu.dispatch_by_priority();
        }
    }

    fn cycle_too_long(&self, cpu: &Cpu, ms: u32, site: u32) {
        cpu.cycle_time_exceeded(ms, site);
    }

    fn hang(&self, cpu: &Cpu, site: u32) {
        cpu.hang_limit_exceeded(site);
    }
}
