//! A unit of version 2.0, loaded as a simulator loads it.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::sync::Mutex;

pub const STATUS_OK: c_int = 0;
pub const STATUS_WARNING: c_int = 1;
pub const STATUS_ERROR: c_int = 3;

type Component = *mut c_void;
/// The C function has further arguments, which are not used here.
type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);

#[repr(C)]
struct Callbacks {
    logger: Logger,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

unsafe extern "C" fn log(to: *mut c_void, _: *const c_char, _: c_int, _: *const c_char, message: *const c_char) {
    // SAFETY: the unit passes back the environment, which lives as long as the instance, and a C string.
    let (list, message) = unsafe { (&*to.cast::<Mutex<Vec<String>>>(), CStr::from_ptr(message)) };
    list.lock().expect("one thread").push(message.to_string_lossy().into_owned());
}

/// The loaded library, and what its model description says.
pub struct Unit {
    handle: *mut c_void,
    guid: String,
    /// Names with their numbers.
    names: Vec<String>,
}

/// An instance.
pub struct Instance<'a> {
    unit: &'a Unit,
    component: Component,
    messages: Box<Mutex<Vec<String>>>,
    _callbacks: Box<Callbacks>,
}

/// Calls a function of the library: its name, its arguments with their types, and the type of its result.
macro_rules! call {
    ($unit:expr, $name:literal ($($value:expr => $ty:ty),*) -> $result:ty) => {{
        let function = $unit.symbol($name);
        // SAFETY: the function has this type by the interface; pointers lead to values of this process.
        unsafe {
            let function = std::mem::transmute::<*mut c_void, unsafe extern "C" fn($($ty),*) -> $result>(function);
            function($($value),*)
        }
    }};
}

impl Unit {
    pub fn load(library: &[u8], packed: &[u8], folder: &Path) -> Result<Unit, String> {
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(packed)).map_err(|error| error.to_string())?;
        let file = archive.by_name("modelDescription.xml").map_err(|error| error.to_string())?;
        let xml = std::io::read_to_string(file).map_err(|error| error.to_string())?;
        let document = roxmltree::Document::parse(&xml).map_err(|error| error.to_string())?;
        let guid = document.root_element().attribute("guid").ok_or("no GUID")?.to_string();
        let variables = document.descendants().filter(|node| node.has_tag_name("ScalarVariable"));
        let names = variables.enumerate().map(|(index, node)| {
            assert_eq!(node.attribute("valueReference"), Some(index.to_string().as_str()));
            node.attribute("name").unwrap_or_default().to_string()
        });
        let names = names.collect();
        let path = folder.join("unit.so");
        std::fs::write(&path, library).map_err(|error| error.to_string())?;
        let path = CString::new(path.display().to_string()).map_err(|error| error.to_string())?;
        // SAFETY: the path is a C string, and what runs when the library is loaded is the start of the runtime.
        let handle = unsafe { libc::dlopen(path.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL) };
        if handle.is_null() {
            // SAFETY: the last call has failed, so there is a C string.
            let error = unsafe { CStr::from_ptr(libc::dlerror()) };
            return Err(error.to_string_lossy().into_owned());
        }
        Ok(Unit { handle, guid, names })
    }

    fn symbol(&self, name: &CStr) -> *mut c_void {
        // SAFETY: the handle is that of a loaded library.
        let found = unsafe { libc::dlsym(self.handle, name.as_ptr()) };
        assert!(!found.is_null(), "{name:?}");
        found
    }

    pub fn instance(&self, name: &str) -> Result<Instance<'_>, String> {
        self.instance_with(name, &self.guid).ok_or_else(|| "no instance".to_string())
    }

    pub fn instance_with(&self, name: &str, guid: &str) -> Option<Instance<'_>> {
        let messages = Box::new(Mutex::new(Vec::new()));
        let null = std::ptr::null::<c_void>();
        let environment = std::ptr::from_ref(&*messages).cast_mut().cast();
        let callbacks = Box::new(Callbacks { logger: log, allocate: null, free: null, finished: null, environment });
        let (name, guid) = (CString::new(name).ok()?, CString::new(guid).ok()?);
        let component = call!(self, c"fmi2Instantiate" (
            name.as_ptr() => *const c_char, 1 => c_int, guid.as_ptr() => *const c_char,
            std::ptr::null() => *const c_char, &raw const *callbacks => *const Callbacks, 0 => c_int, 0 => c_int
        ) -> Component);
        let instance = Instance { unit: self, component, messages, _callbacks: callbacks };
        (!component.is_null()).then_some(instance)
    }

    fn number(&self, name: &str) -> u32 {
        let number = self.names.iter().position(|own| own == name);
        number.unwrap_or_else(|| panic!("no {name}: {:?}", self.names)) as u32
    }
}

impl Instance<'_> {
    /// Initialization from its begin to its end.
    pub fn start(&mut self, time: f64) -> c_int {
        let unit = self.unit;
        let own = self.component;
        let set = call!(unit, c"fmi2SetupExperiment" (
            own => Component, 0 => c_int, 0.0 => f64, time => f64, 0 => c_int, 0.0 => f64) -> c_int);
        assert_eq!(set, STATUS_OK);
        match call!(unit, c"fmi2EnterInitializationMode" (own => Component) -> c_int) {
            STATUS_OK => call!(unit, c"fmi2ExitInitializationMode" (own => Component) -> c_int),
            other => other,
        }
    }

    pub fn step(&mut self, from: f64, length: f64) -> c_int {
        call!(self.unit, c"fmi2DoStep" (self.component => Component, from => f64, length => f64, 1 => c_int) -> c_int)
    }

    pub fn terminate(&mut self) -> c_int {
        call!(self.unit, c"fmi2Terminate" (self.component => Component) -> c_int)
    }

    pub fn reset(&mut self) -> c_int {
        call!(self.unit, c"fmi2Reset" (self.component => Component) -> c_int)
    }

    pub fn boolean(&self, name: &str) -> bool {
        let (number, mut value) = (self.unit.number(name), 0);
        let status = call!(self.unit, c"fmi2GetBoolean" (
            self.component => Component, &number => *const u32, 1 => usize, &mut value => *mut c_int) -> c_int);
        assert_eq!(status, STATUS_OK);
        value != 0
    }

    /// The status of reading the variable with this number.
    pub fn get_boolean(&self, number: u32) -> c_int {
        let mut value = 0;
        call!(self.unit, c"fmi2GetBoolean" (
            self.component => Component, &number => *const u32, 1 => usize, &mut value => *mut c_int) -> c_int)
    }

    pub fn set_boolean(&mut self, name: &str, value: bool) {
        let (number, value) = (self.unit.number(name), c_int::from(value));
        let status = call!(self.unit, c"fmi2SetBoolean" (
            self.component => Component, &number => *const u32, 1 => usize, &value => *const c_int) -> c_int);
        assert_eq!(status, STATUS_OK);
    }

    pub fn integer(&self, name: &str) -> c_int {
        let (number, mut value) = (self.unit.number(name), 0);
        let status = call!(self.unit, c"fmi2GetInteger" (
            self.component => Component, &number => *const u32, 1 => usize, &mut value => *mut c_int) -> c_int);
        assert_eq!(status, STATUS_OK);
        value
    }

    pub fn set_integer(&mut self, name: &str, value: c_int) -> c_int {
        let number = self.unit.number(name);
        call!(self.unit, c"fmi2SetInteger" (
            self.component => Component, &number => *const u32, 1 => usize, &value => *const c_int) -> c_int)
    }

    /// What was told since the last time.
    pub fn messages(&self) -> Vec<String> {
        std::mem::take(&mut *self.messages.lock().expect("one thread"))
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        call!(self.unit, c"fmi2FreeInstance" (self.component => Component) -> ());
    }
}
