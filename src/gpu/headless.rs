//! A device without a window, for the command, the tests and the benches.

use super::Error;

/// A device of our own, and what it is.
///
/// # What Mesa may print meanwhile
///
/// On Linux a program that looks for adapters may find this on its stderr, once for each look:
///
/// ```text
/// error: XDG_RUNTIME_DIR is invalid or not set in the environment.
/// ```
///
/// It is no error of the program's, and nothing is missing afterwards. wgpu asks the Vulkan loader and EGL for devices;
/// Mesa, which stands below both, asks the Wayland compositor which device it runs on (for Vulkan a layer of Mesa's does
/// that, which puts the devices in order), with or without a desktop; and libwayland prints the line where it has no
/// folder to look for the compositor's socket in, as in containers, in cron and in CI. No option of wgpu's turns it off.
/// The environment does, set before the program starts:
///
/// ```sh
/// XDG_RUNTIME_DIR=/run/user/$(id -u)     # as a desktop's session has it; any folder of the user's own will do
/// WAYLAND_DISPLAY=/dev/null/wayland-0    # or a compositor that is never there: an absolute path needs no folder
/// ```
///
/// Within a running program it cannot be set safely (other threads may read the environment). The command `burgeon`
/// starts itself once more in its own place, with the second line set; a service has it in its unit (`Environment=`), tests
/// have it in `.cargo/config.toml` (`[env]`).
#[derive(Clone, Debug)]
pub struct Headless {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: wgpu::AdapterInfo,
}

/// Which adapters come into question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Requirement<'a> {
    /// A hardware adapter, else a software one.
    #[default]
    Any,
    /// A hardware adapter, and no software one: these are 20 to 60 times slower than the CPU backend.
    Hardware,
    /// One whose name, or whose backend's name, holds this text, in any case.
    Named(&'a str),
}

/// Whether it is a device of its own, not a program on the CPU, as lavapipe, llvmpipe, SwiftShader and WARP are.
pub fn is_hardware(info: &wgpu::AdapterInfo) -> bool {
    info.device_type != wgpu::DeviceType::Cpu
}

/// All adapters that can run the engine, the preferred first: hardware before software, and the
/// backends in the order Vulkan, Metal, DX12, GL.
/// wgpu's environment variables (`WGPU_BACKEND` and the like) are honoured.
pub fn adapters() -> Vec<wgpu::Adapter> {
    adapters_in(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

/// The same, in an instance of the caller's choice.
pub fn adapters_in(descriptor: wgpu::InstanceDescriptor) -> Vec<wgpu::Adapter> {
    let backends = descriptor.backends;
    let instance = wgpu::Instance::new(descriptor);
    let mut list = pollster::block_on(instance.enumerate_adapters(backends));
    list.retain(|a| wgpu::Limits::defaults().check_limits(&a.limits()));
    list.sort_by_key(|a| {
        let info = a.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => 2,
            wgpu::DeviceType::Cpu => 3,
        };
        (kind, info.backend == wgpu::Backend::Gl)
    });
    list
}

impl Headless {
    /// A device with WebGPU's default limits and no features.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] where none fits, with the names of those that are there.
    pub fn new(requirement: Requirement) -> Result<Headless, Error> {
        let list = adapters();
        let fits = |a: &&wgpu::Adapter| match requirement {
            Requirement::Any => true,
            Requirement::Hardware => is_hardware(&a.get_info()),
            Requirement::Named(text) => {
                let info = a.get_info();
                let label = format!("{} {:?}", info.name, info.backend).to_lowercase();
                label.contains(&text.to_lowercase())
            }
        };
        match list.iter().find(fits) {
            Some(adapter) => Headless::open(adapter),
            None => Err(Error::NoAdapter(no_adapter(&list, requirement))),
        }
    }

    /// A device of this adapter, with WebGPU's default limits and no features.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Headless, Error> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("burgeon"),
            required_limits: wgpu::Limits::defaults(),
            ..Default::default()
        };
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| Error::NoAdapter(format!("{} gives no device: {e}", info.name)))?;
        Ok(Headless { device, queue, info })
    }
}

fn no_adapter(list: &[wgpu::Adapter], requirement: Requirement) -> String {
    const HINT: &str = "a software one comes with Mesa (Debian and Ubuntu: package mesa-vulkan-drivers)";
    let name = |info: wgpu::AdapterInfo| format!("{} ({:?})", info.name, info.backend);
    let names: Vec<String> = list.iter().map(|a| name(a.get_info())).collect();
    match requirement {
        Requirement::Hardware if !names.is_empty() => {
            format!("there is no hardware adapter, only software: {}", names.join(", "))
        }
        Requirement::Hardware => "no Vulkan, Metal, DX12 or GL adapter was found".to_string(),
        Requirement::Named(text) if !names.is_empty() => {
            format!("no adapter's name holds `{text}`; there are: {}", names.join(", "))
        }
        _ => format!("no Vulkan, Metal, DX12 or GL adapter was found; {HINT}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::DeviceType;

    #[test]
    fn only_what_runs_on_the_cpu_is_no_hardware() {
        let is = |kind| is_hardware(&wgpu::AdapterInfo::new(kind, wgpu::Backend::Vulkan));
        let all =
            [DeviceType::DiscreteGpu, DeviceType::IntegratedGpu, DeviceType::VirtualGpu, DeviceType::Other];
        assert!(all.into_iter().all(is) && !is(DeviceType::Cpu));
    }

    #[test]
    fn what_is_missing_is_said() {
        let none = |requirement| no_adapter(&[], requirement);
        for requirement in [Requirement::Any, Requirement::Hardware, Requirement::Named("x")] {
            assert!(
                none(requirement).starts_with("no Vulkan, Metal, DX12 or GL adapter was found"),
                "{requirement:?}"
            );
        }
        // A software driver does not help who wants none.
        assert!(none(Requirement::Any).contains("Mesa") && !none(Requirement::Hardware).contains("Mesa"));
    }
}
