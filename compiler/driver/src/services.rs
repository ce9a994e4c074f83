//! `[services]` of plc.toml: what clients can reach, and who may connect.

use std::net::SocketAddr;
use std::ops::Range;

use plcc_abi::ProgramImage;
use plcc_abi::services::{Client, Protection, Registers, Right, Role, ServicesConfig, User};
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_services::{options, password, rights};
use serde::Deserialize;
use toml::Spanned;

use crate::keys::Reader;
use crate::project::{duration_ms, number_within};

/// `[services]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServicesKeys {
    s7: Option<Spanned<String>>,
    modbus: Option<Spanned<String>>,
    opcua: Option<Spanned<String>>,
    opcua_folder: Option<Spanned<String>>,
    #[serde(default)]
    opcua_unsecured: bool,
    metrics: Option<Spanned<String>>,
    web: Option<Spanned<String>>,
    tls: Option<Spanned<String>>,
    tables: Option<Spanned<String>>,
    #[serde(default)]
    user: Vec<UserKeys>,
    mqtt: Option<Spanned<String>>,
    mqtt_ca: Option<Spanned<String>>,
    mqtt_certificate: Option<Spanned<String>>,
    mqtt_key: Option<Spanned<String>>,
    sparkplug: Option<Spanned<String>>,
    access: Option<RightKey>,
    #[serde(default)]
    client: Vec<ClientKeys>,
    protection: Option<Spanned<ProtectionKey>>,
    password: Option<Spanned<String>>,
    communication_load: Option<Spanned<i64>>,
    registers: Option<RegisterKeys>,
    #[serde(default)]
    values: Vec<Spanned<String>>,
    interval: Option<Spanned<String>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RightKey {
    Read,
    Write,
    Control,
}

impl From<RightKey> for Right {
    fn from(key: RightKey) -> Right {
        match key {
            RightKey::Read => Right::Read,
            RightKey::Write => Right::Write,
            RightKey::Control => Right::Control,
        }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ProtectionKey {
    None,
    Write,
    ReadWrite,
    Complete,
}

/// `[[services.client]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ClientKeys {
    address: Spanned<String>,
    access: RightKey,
}

/// `[[services.user]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UserKeys {
    name: Spanned<String>,
    role: Role,
    password: Spanned<String>,
}

/// `[services.registers]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RegisterKeys {
    coils: Option<Spanned<String>>,
    discrete_inputs: Option<Spanned<String>>,
    input_registers: Option<Spanned<String>>,
    holding_registers: Option<Spanned<String>>,
}

/// Names of values, which are checked when the program is known.
#[derive(Clone, Debug, Default)]
pub struct Names {
    list: Vec<(String, Span, Use)>,
}

/// What a name is for.
#[derive(Clone, Copy, Debug)]
enum Use {
    /// It is published, with all of its values.
    Published,
    /// A table of Modbus begins there.
    Bits,
    Registers,
}

impl Names {
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Reports names that the program does not have.
    pub fn check(&self, image: &ProgramImage) -> Vec<Diagnostic> {
        let wrong = self.list.iter().filter_map(|(text, span, usage)| {
            let checked = match usage {
                Use::Published => options::check_values(text, image),
                Use::Bits => options::check_registers(text, true, image),
                Use::Registers => options::check_registers(text, false, image),
            };
            let error = checked.err()?;
            let advice = ["; did you mean ", "; switch off "].iter().find_map(|begin| error.find(begin));
            Some(match advice {
                Some(at) => {
                    Diagnostic::new(Code::Project, *span, error[..at].to_string()).help(error[at + 2..].to_string())
                }
                None => Diagnostic::new(Code::Project, *span, error)
                    .help("write a name or an address as for `--print`: `Motor.Speed`, `DB10.DBW0`"),
            })
        });
        wrong.collect()
    }

    /// Warns of data blocks that the program does not have at its start. `has`: whether it has the DB with this number.
    pub fn check_blocks(&self, has: impl Fn(u16) -> bool) -> Vec<Diagnostic> {
        let missing = self.list.iter().filter_map(|(text, span, _)| {
            let number = block_of_address(text).filter(|number| !has(*number))?;
            let title = format!("the program has no data block DB {number}");
            let mut message = Diagnostic::new(Code::Project, *span, title)
                .help("clients get an error until the program makes it: add the block, or write another address");
            message.severity = Severity::Warning;
            Some(message)
        });
        missing.collect()
    }
}

/// The number of the data block of `DB10.DBW0`, `%DB10.DBX0.1`.
fn block_of_address(text: &str) -> Option<u16> {
    let (block, part) = text.trim().trim_start_matches('%').split_once('.')?;
    let is_db = |word: &str| word.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("DB"));
    block.get(2..).filter(|_| is_db(block) && is_db(part))?.parse().ok()
}

/// The names in the table.
pub fn names(keys: &ServicesKeys, file: FileId) -> Names {
    let published = keys.values.iter().map(|key| (key, Use::Published));
    let tables = keys.registers.iter().flat_map(|keys| {
        [
            (&keys.coils, Use::Bits),
            (&keys.discrete_inputs, Use::Bits),
            (&keys.input_registers, Use::Registers),
            (&keys.holding_registers, Use::Registers),
        ]
    });
    let tables = tables.filter_map(|(key, usage)| key.as_ref().map(|key| (key, usage)));
    let entry = |(key, usage): (&Spanned<String>, Use)| (key.get_ref().clone(), Span::new(file, key.span()), usage);
    Names { list: published.chain(tables).map(entry).collect() }
}

/// Where complete protection is asked for, which not every CPU has.
pub fn complete_protection(keys: &ServicesKeys) -> Option<Range<usize>> {
    let protection = keys.protection.as_ref()?;
    matches!(protection.get_ref(), ProtectionKey::Complete).then(|| protection.span())
}

/// Percent of a cycle that communication may take. Source: CPU manuals, communication load.
const LOADS: std::ops::RangeInclusive<i64> = 5..=50;
/// Longest time between two publications of all values.
const INTERVAL_MS_MAX: u32 = 3_600_000;

/// Reads the table. Reports wrong keys and ignores them.
pub fn read(keys: &ServicesKeys, file: FileId) -> (ServicesConfig, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    reader.one_address_each(keys);
    let password = keys.password.as_ref().and_then(|key| reader.hash(key, "plcc password"));
    let address = |text: &str| options::address(text).map(|_| ());
    let help = "write a port for clients on this computer, as in `\"10102\"`, or an address with a port, as in `\"0.0.0.0:10102\"`";
    let config = ServicesConfig {
        linked: true,
        s7: keys.s7.as_ref().and_then(|key| reader.checked(key, help, address)),
        modbus: keys.modbus.as_ref().and_then(|key| reader.checked(key, help, address)),
        opcua: keys.opcua.as_ref().and_then(|key| reader.checked(key, help, address)),
        opcua_folder: keys.opcua_folder.as_ref().and_then(|key| reader.file_name(key, "folder", "opcua")),
        opcua_unsecured: keys.opcua_unsecured,
        metrics: keys.metrics.as_ref().and_then(|key| reader.checked(key, help, address)),
        web: keys.web.as_ref().and_then(|key| reader.checked(key, help, address)),
        tables: keys.tables.as_ref().and_then(|key| reader.file_name(key, "folder", "tables")),
        tls: keys.tls.as_ref().and_then(|key| reader.file_name(key, "folder", "tls")),
        users: reader.users(&keys.user),
        mqtt: keys.mqtt.as_ref().and_then(|key| {
            let wrong = options::check_broker(key.get_ref()).err();
            if let Some(why) = &wrong {
                reader.report(key, "not the URL of a broker".to_string(), why);
            }
            wrong.is_none().then(|| key.get_ref().clone())
        }),
        mqtt_ca: keys.mqtt_ca.as_ref().and_then(|key| reader.file_name(key, "file", "ca.pem")),
        mqtt_certificate: keys.mqtt_certificate.as_ref().and_then(|key| reader.file_name(key, "file", "plc.pem")),
        mqtt_key: keys.mqtt_key.as_ref().and_then(|key| reader.file_name(key, "file", "plc.key")),
        sparkplug: keys.sparkplug.as_ref().and_then(|key| {
            let check = |text: &str| {
                options::check_node(text).map_err(|_| format!("`{text}` is not the name of a node of Sparkplug B"))
            };
            reader.checked(key, "write `GROUP/NODE` or `GROUP/NODE/DEVICE`", check)
        }),
        access: keys.access.map(Right::from),
        clients: reader.clients(&keys.client),
        protection: match keys.protection.as_ref().map(Spanned::get_ref) {
            None | Some(ProtectionKey::None) => Protection::None,
            Some(ProtectionKey::Write) => Protection::Write,
            Some(ProtectionKey::ReadWrite) => Protection::ReadWrite,
            Some(ProtectionKey::Complete) => Protection::Complete,
        },
        password,
        drawings: Vec::new(),
        probes: None,
        communication_load: keys.communication_load.as_ref().and_then(|key| {
            let number = number_within::<u8>(key, LOADS, "a percentage");
            number.map_err(|title| reader.report(key, title, "a CPU gives its clients 5 to 50 % of a cycle")).ok()
        }),
        registers: keys.registers.as_ref().map(registers).unwrap_or_default(),
        values: keys.values.iter().map(|key| key.get_ref().clone()).collect(),
        interval_ms: keys.interval.as_ref().and_then(|key| reader.interval(key)),
    };
    (config, reader.diagnostics)
}

fn registers(keys: &RegisterKeys) -> Registers {
    let usual = Registers::default();
    let given = |key: &Option<Spanned<String>>, usual| key.as_ref().map_or(usual, |key| key.get_ref().clone());
    Registers {
        coils: given(&keys.coils, usual.coils),
        discrete_inputs: given(&keys.discrete_inputs, usual.discrete_inputs),
        input_registers: given(&keys.input_registers, usual.input_registers),
        holding_registers: given(&keys.holding_registers, usual.holding_registers),
    }
}

impl Reader {
    /// A text that passes a test.
    fn checked(
        &mut self,
        key: &Spanned<String>,
        help: &str,
        check: impl Fn(&str) -> Result<(), String>,
    ) -> Option<String> {
        match check(key.get_ref()) {
            Ok(()) => Some(key.get_ref().clone()),
            Err(title) => {
                self.report(key, title, help);
                None
            }
        }
    }

    /// The hash of a password, which `command` makes.
    fn hash(&mut self, key: &Spanned<String>, command: &str) -> Option<String> {
        let help = format!("`{command}` makes the hash of a password that it reads");
        self.checked(key, &help, |text| match password::is_hash(text) {
            true => Ok(()),
            // What is wrong here may be the password itself.
            false => Err("this is not the hash of a password".to_string()),
        })
    }

    fn users(&mut self, keys: &[UserKeys]) -> Vec<User> {
        let mut users: Vec<User> = Vec::new();
        for key in keys {
            let name = key.name.get_ref();
            let wrong = match name.is_empty() {
                true => Some("a user without a name".to_string()),
                false => {
                    users.iter().any(|user| user.name == *name).then(|| format!("two users have the name `{name}`"))
                }
            };
            if let Some(title) = wrong {
                self.report(&key.name, title, "give each user another name");
                continue;
            }
            if let Some(password) = self.hash(&key.password, "plcc password --user") {
                users.push(User { name: name.clone(), role: key.role, password });
            }
        }
        users
    }

    /// Reports a service with the port of another one.
    fn one_address_each(&mut self, keys: &ServicesKeys) {
        let services = [
            ("s7", &keys.s7),
            ("modbus", &keys.modbus),
            ("opcua", &keys.opcua),
            ("metrics", &keys.metrics),
            ("web", &keys.web),
        ];
        let mut known: Vec<(&str, SocketAddr)> = Vec::new();
        for (name, key) in services {
            let Some(key) = key else { continue };
            let Ok(address) = options::address(key.get_ref()) else { continue };
            let is_same = |other: &SocketAddr| {
                let everywhere = other.ip().is_unspecified() || address.ip().is_unspecified();
                address.port() != 0 && other.port() == address.port() && (everywhere || other.ip() == address.ip())
            };
            match known.iter().find(|(_, other)| is_same(other)) {
                Some((other, _)) => {
                    let title = format!("`{name}` and `{other}` have the same port");
                    self.report(key, title, "give each service a port of its own");
                }
                None => known.push((name, address)),
            }
        }
    }

    fn clients(&mut self, keys: &[ClientKeys]) -> Vec<Client> {
        let mut clients: Vec<Client> = Vec::new();
        for key in keys {
            let address = key.address.get_ref();
            if !rights::is_network(address) {
                let title = format!("`{address}` is neither a computer nor a network");
                self.report(&key.address, title, "write `192.168.0.7`, or `192.168.0.0/24`");
                continue;
            }
            // Which of them counts, no reader could see.
            if let Some(other) = clients.iter().find(|client| rights::is_same_network(&client.address, address)) {
                let title = match other.address == *address {
                    true => format!("two entries are for `{address}`"),
                    false => format!("the entries for `{}` and `{address}` are for the same computers", other.address),
                };
                self.report(&key.address, title, "leave one of them out: it says what the computer may do");
                continue;
            }
            clients.push(Client { address: address.clone(), right: key.access.into() });
        }
        clients
    }

    fn interval(&mut self, key: &Spanned<String>) -> Option<u32> {
        let ms = duration_ms(key.get_ref()).filter(|ms| (100..=INTERVAL_MS_MAX).contains(ms));
        if ms.is_none() {
            self.report(key, format!("`{}` is not a time from 100 ms to 1 h", key.get_ref()), "write `10s`");
        }
        ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_diag::SourceFile;

    /// The configuration of a plc.toml, and its messages.
    fn config(text: &str) -> (ServicesConfig, Vec<String>) {
        let source = SourceFile::new("plc.toml", text);
        let (project, messages) = crate::project::parse(FileId(0), &source);
        (project.config.services, messages.into_iter().map(|message| message.title).collect())
    }

    #[test]
    fn all_keys_are_read() {
        let hash = password::hash("secret").unwrap();
        let (read, messages) = config(&format!(
            "[services]\ns7 = \"10102\"\nmodbus = \"0.0.0.0:502\"\naccess = \"read\"\nprotection = \"read-write\"\n\
             password = \"{hash}\"\ncommunication_load = 30\nvalues = [\"MW2\"]\ninterval = \"5s\"\n\
             tls = \"web\"\ntables = \"tables\"\nmqtt = \"mqtts://b\"\nmqtt_ca = \"ca.pem\"\nsparkplug = \"plant/line\"\n\
             [services.registers]\nholding_registers = \"DB1.DBW0\"\n\
             [[services.client]]\naddress = \"10.0.0.0/8\"\naccess = \"control\"\n"
        ));
        assert_eq!(messages, Vec::<String>::new());
        assert_eq!(
            (read.linked, read.s7.as_deref(), read.modbus.as_deref()),
            (true, Some("10102"), Some("0.0.0.0:502"))
        );
        assert_eq!(
            [read.tls.as_deref(), read.mqtt.as_deref(), read.mqtt_ca.as_deref(), read.sparkplug.as_deref()],
            [Some("web"), Some("mqtts://b"), Some("ca.pem"), Some("plant/line")]
        );
        assert_eq!(read.tables.as_deref(), Some("tables"));
        assert_eq!((read.access, read.protection), (Some(Right::Read), Protection::ReadWrite));
        assert_eq!((read.communication_load, read.interval_ms), (Some(30), Some(5000)));
        assert_eq!(read.clients, [Client { address: "10.0.0.0/8".to_string(), right: Right::Control }]);
        assert_eq!((read.registers.coils.as_str(), read.registers.holding_registers.as_str()), ("Q0.0", "DB1.DBW0"));
        assert!(!config("name = \"a\"\n").0.linked);
    }

    #[test]
    fn computers_have_one_entry_each() {
        let client = |address: &str| format!("[[services.client]]\naddress = \"{address}\"\naccess = \"read\"\n");
        let addresses = ["10.0.0.7", "10.0.0.7", "10.0.0.0/8", "10.1.0.0/8", "10.0.0.0/16"].map(client);
        let (read, messages) = config(&format!("[services]\n{}", addresses.concat()));
        let wanted = [
            "two entries are for `10.0.0.7`",
            "the entries for `10.0.0.0/8` and `10.1.0.0/8` are for the same computers",
        ];
        assert_eq!(messages, wanted);
        assert_eq!(read.clients.len(), 3);
    }

    #[test]
    fn users_have_names_of_their_own() {
        let hash = password::hash("secret").unwrap();
        let user =
            |name: &str| format!("[[services.user]]\nname = \"{name}\"\nrole = \"look\"\npassword = \"{hash}\"\n");
        let (read, messages) = config(&["[services]\n", &user("anna"), &user("anna"), &user("")].concat());
        assert_eq!(messages, ["two users have the name `anna`", "a user without a name"]);
        assert_eq!(read.users.len(), 1);
    }

    #[test]
    fn wrong_values_are_reported_and_passwords_are_not_shown() {
        let (read, messages) = config(
            "[services]\ns7 = \"plant:102\"\nmqtt = \"me:secret@b\"\npassword = \"secret\"\ncommunication_load = 90\n\
             opcua_folder = \"\"\ninterval = \"1ms\"\n[[services.client]]\naddress = \"plant\"\naccess = \"read\"\n",
        );
        assert_eq!(messages.len(), 7, "{messages:?}");
        assert!(messages.iter().all(|message| !message.contains("secret")), "{messages:?}");
        assert_eq!(read, ServicesConfig { linked: true, ..ServicesConfig::default() });
    }
}
