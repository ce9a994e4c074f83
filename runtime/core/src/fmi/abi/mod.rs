//! The C functions of a unit. A simulator calls those of one version; both work on [`Component`].
//!
//! What a simulator passes is checked as far as it can be: numbers, types, texts, null pointers, the order of calls.

mod v2;
mod v3;

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

use plcc_abi::ProgramImage;

use super::instance::{self, Instance, Scalar, Step};
use super::variables::{Kind, Variable, variables};
use crate::code::{Entries, EntryFunction};
use crate::linked::{LinkedCode, linked_program};

/// Result of a call, the same numbers in both versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
enum Status {
    Ok = 0,
    Warning = 1,
    Error = 3,
}

/// Nanoseconds in a second.
const NS: f64 = 1e9;
/// The last virtual time that a step may end at: 100 years.
const SECONDS_MAX: f64 = 3.2e9;

/// What all instances share.
struct Program {
    image: Arc<ProgramImage>,
    entries: Vec<EntryFunction>,
    variables: Arc<[Variable]>,
    token: String,
}

/// The linked program. `Err`: the file is damaged.
fn program() -> Result<&'static Program, &'static str> {
    static PROGRAM: OnceLock<Result<Program, String>> = OnceLock::new();
    let made = PROGRAM.get_or_init(|| {
        let (mut image, entries) = linked_program(0)?;
        let token = super::token(&image);
        // Instances would write to one file.
        image.config.retain.file = None;
        let image = Arc::new(image);
        let (list, _) = variables(&instance::cpu(&image, code_of(&entries)));
        Ok(Program { image, entries, variables: list.into(), token })
    });
    made.as_ref().map_err(String::as_str)
}

/// The code of an instance.
fn code_of(entries: &[EntryFunction]) -> Rc<LinkedCode> {
    Rc::new(LinkedCode(Entries::new(entries.to_vec())))
}

/// A function of the simulator that takes messages: environment, status, category, text.
type Tell = Box<dyn Fn(Status, &CStr, &CStr)>;

/// Where an instance is in the order of calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Instantiated,
    Initialization,
    Stepping,
    Terminated,
}

/// An instance as the simulator knows it, by its address.
struct Component {
    instance: Instance,
    program: &'static Program,
    tell: Tell,
    /// Messages that are not problems are sent too.
    talkative: bool,
    phase: Phase,
    /// Time of the simulator at the startup of the CPU, and now.
    start: f64,
    now: f64,
    /// Texts that were handed out; they last until the next call that hands out some.
    texts: Vec<CString>,
}

impl Component {
    /// A new instance; `None`: a message to the simulator says why not.
    fn new(token: *const c_char, tell: Tell, talkative: bool) -> Option<Box<Component>> {
        let refuse = |message: &str| {
            tell(Status::Error, c"logStatusError", &c_text(message));
            None
        };
        let program = match program() {
            Ok(program) => program,
            Err(error) => return refuse(&format!("this unit is damaged: {error}")),
        };
        // SAFETY: the simulator passes a C string or null.
        match unsafe { text(token) } {
            Some(given) if given == program.token => {}
            Some(given) => {
                let own = &program.token;
                return refuse(&format!("the model description has {given}, but the program is {own}: build it again"));
            }
            None => return refuse("the simulator passes no GUID or token"),
        }
        Some(Box::new(Component {
            instance: new_instance(program),
            program,
            tell,
            talkative,
            phase: Phase::Instantiated,
            start: 0.0,
            now: 0.0,
            texts: Vec::new(),
        }))
    }

    fn say(&self, status: Status, message: &str) -> Status {
        let category = match status {
            Status::Ok => c"logEvents",
            Status::Warning => c"logStatusWarning",
            Status::Error => c"logStatusError",
        };
        if self.talkative || status != Status::Ok {
            (self.tell)(status, category, &c_text(message));
        }
        status
    }

    fn settle(&self, result: Result<(), String>) -> Status {
        result.map_or_else(|message| self.say(Status::Error, &message), |()| Status::Ok)
    }

    fn expect(&self, allowed: &[Phase], what: &str) -> Result<(), String> {
        match allowed.contains(&self.phase) {
            true => Ok(()),
            false => Err(format!("{what} is not possible now: the instance is in the phase {:?}", self.phase)),
        }
    }

    fn enter_initialization(&mut self, start: f64) -> Result<(), String> {
        self.expect(&[Phase::Instantiated], "initialization")?;
        if !start.is_finite() {
            return Err(format!("the start time {start} is not a time"));
        }
        (self.start, self.now, self.phase) = (start, start, Phase::Initialization);
        Ok(())
    }

    fn exit_initialization(&mut self) -> Status {
        if let Err(message) = self.expect(&[Phase::Initialization], "the end of initialization") {
            return self.say(Status::Error, &message);
        }
        self.phase = Phase::Stepping;
        let step = self.instance.start_up();
        self.told(&step)
    }

    /// Steps from `from` to `from + length`, in seconds.
    fn step(&mut self, from: f64, length: f64) -> Status {
        let checked = self.expect(&[Phase::Stepping], "a step").and_then(|()| {
            let end = from + length;
            if !(length >= 0.0 && from.is_finite() && end - self.start <= SECONDS_MAX) {
                return Err(format!("a step from {from} s of {length} s is not possible"));
            }
            // Rounding of the simulator is accepted, going back is not.
            if (from - self.now).abs() > 1e-3 * length + 1e-9 {
                return Err(format!("the step begins at {from} s, but the last one ended at {} s", self.now));
            }
            Ok(end)
        });
        let end = match checked {
            Ok(end) => end,
            Err(message) => return self.say(Status::Error, &message),
        };
        self.now = end;
        let step = self.instance.run_until(((end - self.start) * NS).round() as u64);
        self.told(&step)
    }

    fn told(&self, step: &Step) -> Status {
        match step {
            Step::Done => Status::Ok,
            Step::Stopped { fault: true, text } => self.say(Status::Warning, &format!("the CPU is in STOP: {text}")),
            Step::Stopped { fault: false, text } => self.say(Status::Ok, &format!("the CPU is in STOP: {text}")),
        }
    }

    fn terminate(&mut self) -> Result<(), String> {
        self.expect(&[Phase::Stepping, Phase::Initialization, Phase::Terminated], "the end of the simulation")?;
        self.instance.end();
        self.phase = Phase::Terminated;
        Ok(())
    }

    fn reset(&mut self) {
        self.instance = new_instance(self.program);
        (self.phase, self.start, self.now) = (Phase::Instantiated, 0.0, 0.0);
    }

    /// Values of variables whose type the version calls `name`.
    fn read(&self, numbers: &[u32], name: &str, type_of: fn(Kind) -> &'static str) -> Result<Vec<Scalar>, String> {
        let one = |&number: &u32| {
            self.check(number, name, type_of)?;
            self.instance.read(number)
        };
        numbers.iter().map(one).collect()
    }

    fn check(&self, number: u32, name: &str, type_of: fn(Kind) -> &'static str) -> Result<(), String> {
        let variable = self.instance.variable(number)?;
        let own = type_of(variable.kind);
        match own == name {
            true => Ok(()),
            false => Err(format!("{} is of type {own}, not {name}", variable.name)),
        }
    }

    /// Sets the variables in their order. `Err`: the first error; those before it are set.
    fn write(
        &mut self,
        numbers: &[u32],
        name: &str,
        type_of: fn(Kind) -> &'static str,
        value: &mut dyn FnMut(usize) -> Result<Scalar, String>,
    ) -> Result<(), String> {
        self.expect(&[Phase::Instantiated, Phase::Initialization, Phase::Stepping], "setting values")?;
        for (index, &number) in numbers.iter().enumerate() {
            self.check(number, name, type_of)?;
            self.instance.write(number, &value(index)?)?;
        }
        Ok(())
    }

    /// Keeps texts until the next call, and hands out where they are.
    fn lend(&mut self, values: &[Scalar], out: &mut [*const c_char]) {
        self.texts = values.iter().map(|value| c_text(&scalar_text(value))).collect();
        for (place, text) in out.iter_mut().zip(&self.texts) {
            *place = text.as_ptr();
        }
    }
}

fn new_instance(program: &'static Program) -> Instance {
    let cpu = instance::cpu(&program.image, code_of(&program.entries));
    Instance::new(cpu, program.variables.clone())
}

fn scalar_text(value: &Scalar) -> String {
    match value {
        Scalar::Bool(bit) => bit.to_string(),
        Scalar::Whole(whole) => whole.to_string(),
        Scalar::Float(number) => number.to_string(),
        Scalar::Text(text) => text.clone(),
    }
}

/// For C, which ends a text at a zero.
fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// The text at `pointer`; `None`: null or not UTF-8.
///
/// # Safety
/// `pointer` is null or leads to a C string that outlives the result.
unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a str> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(pointer) }.to_str().ok()
}

/// The elements at `pointer`.
///
/// # Safety
/// `pointer` is null or leads to `length` elements that outlive the result.
unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> &'a [T] {
    match pointer.is_null() || length == 0 {
        true => &[],
        // SAFETY: as the caller promises.
        false => unsafe { std::slice::from_raw_parts(pointer, length) },
    }
}

/// The elements at `pointer`, to be written.
///
/// # Safety
/// As [`slice`], and nothing else uses them.
unsafe fn slice_mut<'a, T>(pointer: *mut T, length: usize) -> &'a mut [T] {
    match pointer.is_null() || length == 0 {
        true => &mut [],
        // SAFETY: as the caller promises.
        false => unsafe { std::slice::from_raw_parts_mut(pointer, length) },
    }
}

/// Does something with the component at `pointer`.
///
/// # Safety
/// `pointer` is null or came from [`lend_component`], and no other thread uses it now.
unsafe fn with(pointer: *mut c_void, act: impl FnOnce(&mut Component) -> Status) -> Status {
    // SAFETY: as the caller promises.
    match unsafe { pointer.cast::<Component>().as_mut() } {
        Some(component) => act(component),
        None => Status::Error,
    }
}

/// Hands a component to the simulator.
fn lend_component(component: Option<Box<Component>>) -> *mut c_void {
    component.map_or(std::ptr::null_mut(), |component| Box::into_raw(component).cast())
}

/// Takes a component back.
///
/// # Safety
/// As [`with`]; afterwards `pointer` is not used.
unsafe fn free(pointer: *mut c_void) {
    if !pointer.is_null() {
        // SAFETY: as the caller promises.
        drop(unsafe { Box::from_raw(pointer.cast::<Component>()) });
    }
}

/// Functions for what a unit need not be able to do, by its model description. They say so.
macro_rules! absent {
    ($($name:ident)*) => {
        $(
            /// Not among the capabilities of the unit.
            ///
            /// # Safety
            /// As for all functions of the interface: the first argument is an instance.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut c_void) -> c_int {
                let message = concat!(stringify!($name), " is not among the capabilities of this unit");
                // SAFETY: the simulator passes an instance that it got.
                unsafe { super::with(instance, |component| component.say(super::Status::Error, message)) as c_int }
            }
        )*
    };
}

pub(crate) use absent;

/// The result of a C function.
fn code(status: Status) -> c_int {
    status as c_int
}
