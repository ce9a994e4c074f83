//! Version 3.0 of the interface, co-simulation. Source: FMI 3.0.2, chapters 2 and 4.

use std::ffi::{CStr, c_char, c_double, c_int, c_void};

use super::{Component, Scalar, Status, absent, code, free, lend_component, slice, slice_mut, text, with};
use crate::fmi::variables::{Kind, TIME_NUMBER};

type LogMessage = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log: Option<LogMessage>,
    _update: *const c_void,
) -> *mut c_void {
    let tell = move |status: Status, category: &CStr, message: &CStr| {
        let Some(log) = log else { return };
        // SAFETY: the simulator's own function with its own environment, which live as long as the instance.
        unsafe { log(environment, status as c_int, category.as_ptr(), message.as_ptr()) }
    };
    lend_component(Component::new(token, Box::new(tell), logging))
}

/// Model exchange is not among the capabilities of the unit.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange() -> *mut c_void {
    std::ptr::null_mut()
}

/// Scheduled execution is not among the capabilities of the unit.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> *mut c_void {
    std::ptr::null_mut()
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    // SAFETY: the simulator passes an instance that it got, for the last time.
    unsafe { free(instance) }
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    let set = |component: &mut Component| {
        component.talkative = on;
        Status::Ok
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, set) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _has_tolerance: bool,
    _tolerance: c_double,
    start: c_double,
    _has_stop: bool,
    _stop: c_double,
) -> c_int {
    let enter = |component: &mut Component| {
        let entered = component.enter_initialization(start);
        component.settle(entered)
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, enter) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> c_int {
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, Component::exit_initialization) })
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: *mut c_void) -> c_int {
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
pub unsafe extern "C" fn fmi3Reset(instance: *mut c_void) -> c_int {
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
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    from: c_double,
    length: c_double,
    _no_set: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last: *mut c_double,
) -> c_int {
    let step = |component: &mut Component| {
        let status = component.step(from, length);
        for place in [event_needed, terminate, early_return] {
            // SAFETY: the simulator passes places for the results, or null.
            if let Some(place) = unsafe { place.as_mut() } {
                *place = false;
            }
        }
        // SAFETY: as above.
        if let Some(last) = unsafe { last.as_mut() } {
            *last = component.now;
        }
        status
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, step) })
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
                numbers: *const u32,
                count: usize,
                values: *mut $ty,
                value_count: usize,
            ) -> c_int {
                // SAFETY: the simulator passes arrays with so many elements.
                let (numbers, values) = unsafe { (slice(numbers, count), slice_mut(values, value_count)) };
                let get = |component: &mut Component| match read(component, numbers, $name) {
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
                numbers: *const u32,
                count: usize,
                values: *const $ty,
                value_count: usize,
            ) -> c_int {
                // SAFETY: the simulator passes arrays with so many elements.
                let (numbers, values) = unsafe { (slice(numbers, count), slice(values, value_count)) };
                let set = |component: &mut Component| {
                    let take: fn($ty) -> Scalar = $in;
                    let mut value = |index: usize| {
                        let value = values.get(index).map(|value| take(*value));
                        value.ok_or_else(|| "there are fewer values than variables".to_string())
                    };
                    let written = component.write(numbers, $name, Kind::name_v3, &mut value);
                    component.settle(written)
                };
                // SAFETY: the simulator passes an instance that it got.
                code(unsafe { with(instance, set) })
            }
        )*
    };
}

/// Values of variables, and the time.
fn read(component: &Component, numbers: &[u32], name: &str) -> Result<Vec<Scalar>, String> {
    let one = |number: &u32| match (*number, name) {
        (TIME_NUMBER, "Float64") => Ok(Scalar::Float(component.now)),
        _ => component.read(std::slice::from_ref(number), name, Kind::name_v3).map(|mut values| values.remove(0)),
    };
    numbers.iter().map(one).collect()
}

fn whole(value: &Scalar) -> i128 {
    if let Scalar::Whole(whole) = value { *whole } else { 0 }
}

fn number(value: &Scalar) -> f64 {
    if let Scalar::Float(number) = value { *number } else { f64::NAN }
}

values! {
    fmi3GetFloat32 fmi3SetFloat32 f32, "Float32", |value| number(value) as f32, |value| Scalar::Float(value.into());
    fmi3GetFloat64 fmi3SetFloat64 f64, "Float64", number, Scalar::Float;
    fmi3GetInt8 fmi3SetInt8 i8, "Int8", |value| whole(value) as i8, |value| Scalar::Whole(value.into());
    fmi3GetUInt8 fmi3SetUInt8 u8, "UInt8", |value| whole(value) as u8, |value| Scalar::Whole(value.into());
    fmi3GetInt16 fmi3SetInt16 i16, "Int16", |value| whole(value) as i16, |value| Scalar::Whole(value.into());
    fmi3GetUInt16 fmi3SetUInt16 u16, "UInt16", |value| whole(value) as u16, |value| Scalar::Whole(value.into());
    fmi3GetInt32 fmi3SetInt32 i32, "Int32", |value| whole(value) as i32, |value| Scalar::Whole(value.into());
    fmi3GetUInt32 fmi3SetUInt32 u32, "UInt32", |value| whole(value) as u32, |value| Scalar::Whole(value.into());
    fmi3GetInt64 fmi3SetInt64 i64, "Int64", |value| whole(value) as i64, |value| Scalar::Whole(value.into());
    fmi3GetUInt64 fmi3SetUInt64 u64, "UInt64", |value| whole(value) as u64, |value| Scalar::Whole(value.into());
    fmi3GetBoolean fmi3SetBoolean bool, "Boolean", |value| *value == Scalar::Bool(true), Scalar::Bool;
}

/// # Safety
/// Called by a simulator as the interface says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    instance: *mut c_void,
    numbers: *const u32,
    count: usize,
    values: *mut *const c_char,
    value_count: usize,
) -> c_int {
    // SAFETY: the simulator passes arrays with so many elements.
    let (numbers, values) = unsafe { (slice(numbers, count), slice_mut(values, value_count)) };
    let get = |component: &mut Component| match component.read(numbers, "String", Kind::name_v3) {
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
pub unsafe extern "C" fn fmi3SetString(
    instance: *mut c_void,
    numbers: *const u32,
    count: usize,
    values: *const *const c_char,
    value_count: usize,
) -> c_int {
    // SAFETY: the simulator passes arrays with so many elements.
    let (numbers, values) = unsafe { (slice(numbers, count), slice(values, value_count)) };
    let set = |component: &mut Component| {
        let mut value = |index: usize| {
            // SAFETY: the elements are C strings.
            let given = values.get(index).and_then(|pointer| unsafe { text(*pointer) });
            given.map(|given| Scalar::Text(given.to_string())).ok_or_else(|| "a text is not UTF-8".to_string())
        };
        let written = component.write(numbers, "String", Kind::name_v3, &mut value);
        component.settle(written)
    };
    // SAFETY: the simulator passes an instance that it got.
    code(unsafe { with(instance, set) })
}

absent! {
    fmi3GetBinary fmi3SetBinary fmi3GetClock fmi3SetClock fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies
    fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
    fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3EnterEventMode fmi3EnterContinuousTimeMode
    fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStateDerivatives
    fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates
    fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3EnterStepMode fmi3GetOutputDerivatives
    fmi3ActivateModelPartition
}
