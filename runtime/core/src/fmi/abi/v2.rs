//! Version 2.0 of the interface, co-simulation. Source: FMI 2.0.4, chapters 2.1 and 4.2.

use std::ffi::{CStr, c_char, c_double, c_int, c_uint, c_void};

use super::{Component, Scalar, Status, absent, code, free, lend_component, slice, slice_mut, text, with};
use crate::fmi::variables::Kind;

/// The unit is instantiated for co-simulation.
const CO_SIMULATION: c_int = 1;

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// What the simulator offers.
#[repr(C)]
pub struct CallbackFunctions {
    logger: Option<Logger>,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// `default`, the only types that there are.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    _resources: *const c_char,
    functions: *const CallbackFunctions,
    _visible: c_int,
    logging: c_int,
) -> *mut c_void {
    // SAFETY: the simulator passes C strings and its functions, or null.
    let (name, functions) = unsafe { (text(name).unwrap_or("plc"), functions.as_ref()) };
    let name = super::c_text(name);
    let (logger, environment) = functions.map_or((None, std::ptr::null_mut()), |all| (all.logger, all.environment));
    let tell = move |status: Status, category: &CStr, message: &CStr| {
        let Some(logger) = logger else { return };
        // The message is a format; nothing in it may be one of a value.
        let message = super::c_text(&message.to_string_lossy().replace('%', "%%"));
        // SAFETY: the simulator's own function with its own environment, which live as long as the instance.
        unsafe { logger(environment, name.as_ptr(), status as c_int, category.as_ptr(), message.as_ptr()) }
    };
    if kind != CO_SIMULATION {
        tell(Status::Error, c"logStatusError", c"this unit is for co-simulation only");
        return std::ptr::null_mut();
    }
    lend_component(Component::new(guid, Box::new(tell), logging != 0))
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(instance: *mut c_void) {
    // SAFETY: the simulator passes an instance that it got, for the last time.
    unsafe { free(instance) }
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    instance: *mut c_void,
    on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    let set = |component: &mut Component| {
        component.talkative = on != 0;
        Status::Ok
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, set) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    instance: *mut c_void,
    _has_tolerance: c_int,
    _tolerance: c_double,
    start: c_double,
    _has_stop: c_int,
    _stop: c_double,
) -> c_int {
    let set = |component: &mut Component| {
        component.start = start;
        Status::Ok
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, set) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(instance: *mut c_void) -> c_int {
    let enter = |component: &mut Component| {
        let entered = component.enter_initialization(component.start);
        component.settle(entered)
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, enter) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(instance: *mut c_void) -> c_int {
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, Component::exit_initialization) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(instance: *mut c_void) -> c_int {
    let end = |component: &mut Component| {
        let ended = component.terminate();
        component.settle(ended)
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, end) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(instance: *mut c_void) -> c_int {
    let reset = |component: &mut Component| {
        component.reset();
        Status::Ok
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, reset) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(instance: *mut c_void, from: c_double, length: c_double, _no_set: c_int) -> c_int {
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, |component| component.step(from, length)) })
}

/// The functions that get and set values of a type: their names, the type and its name, and how its values go in and out.
macro_rules! values {
    ($($get:ident $set:ident $ty:ty, $name:literal, $out:expr, $in:expr;)*) => {
        $(
            /// # Safety
            /// Called by a simulator as the interface says.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $get(
                instance: *mut c_void,
                numbers: *const c_uint,
                count: usize,
                values: *mut $ty,
            ) -> c_int {
                // SAFETY: the simulator passes arrays with so many elements.
                let (numbers, values) = unsafe { (slice(numbers, count), slice_mut(values, count)) };
                let get = |component: &mut Component| match component.read(numbers, $name, Kind::name_v2) {
                    Ok(read) => {
                        let out: fn(&Scalar) -> $ty = $out;
                        values.iter_mut().zip(&read).for_each(|(place, value)| *place = out(value));
                        Status::Ok
                    }
                    Err(message) => component.say(Status::Error, &message),
                };
                // SAFETY: the simulator passes an instance that it got.
                code(unsafe { with(instance, get) })
            }

            /// # Safety
            /// Called by a simulator as the interface says.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $set(
                instance: *mut c_void,
                numbers: *const c_uint,
                count: usize,
                values: *const $ty,
            ) -> c_int {
                // SAFETY: the simulator passes arrays with so many elements.
                let (numbers, values) = unsafe { (slice(numbers, count), slice(values, count)) };
                let set = |component: &mut Component| {
                    let take: fn($ty) -> Scalar = $in;
                    let mut value =
                        |index: usize| values.get(index).map(|value| take(*value)).ok_or_else(|| "no values".to_string());
                    let written = component.write(numbers, $name, Kind::name_v2, &mut value);
                    component.settle(written)
                };
                // SAFETY: the simulator passes an instance that it got.
                code(unsafe { with(instance, set) })
            }
        )*
    };
}

fn number(value: &Scalar) -> f64 {
    match value {
        Scalar::Float(number) => *number,
        Scalar::Whole(whole) => *whole as f64,
        Scalar::Bool(_) | Scalar::Text(_) => f64::NAN,
    }
}

fn whole(value: &Scalar) -> c_int {
    if let Scalar::Whole(whole) = value { *whole as c_int } else { 0 }
}

values! {
    fmi2GetReal fmi2SetReal c_double, "Real", number, Scalar::Float;
    fmi2GetInteger fmi2SetInteger c_int, "Integer", whole, |value| Scalar::Whole(value.into());
    fmi2GetBoolean fmi2SetBoolean c_int, "Boolean", |value| (*value == Scalar::Bool(true)).into(), |value| Scalar::Bool(value != 0);
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    instance: *mut c_void,
    numbers: *const c_uint,
    count: usize,
    values: *mut *const c_char,
) -> c_int {
    // SAFETY: the simulator passes arrays with so many elements.
    let (numbers, values) = unsafe { (slice(numbers, count), slice_mut(values, count)) };
    let get = |component: &mut Component| match component.read(numbers, "String", Kind::name_v2) {
        Ok(read) => {
            component.lend(&read, values);
            Status::Ok
        }
        Err(message) => component.say(Status::Error, &message),
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, get) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    instance: *mut c_void,
    numbers: *const c_uint,
    count: usize,
    values: *const *const c_char,
) -> c_int {
    // SAFETY: the simulator passes arrays with so many elements.
    let (numbers, values) = unsafe { (slice(numbers, count), slice(values, count)) };
    let set = |component: &mut Component| {
        let mut value = |index: usize| {
            // SAFETY: the elements are C strings.
            let given = values.get(index).and_then(|pointer| unsafe { text(*pointer) });
            given.map(|given| Scalar::Text(given.to_string())).ok_or_else(|| "a text is not UTF-8".to_string())
        };
        let written = component.write(numbers, "String", Kind::name_v2, &mut value);
        component.settle(written)
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, set) })
}

absent! {
    fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
    fmi2GetDirectionalDerivative fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2CancelStep
    fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus
}
