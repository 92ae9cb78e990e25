//! The adapter that draws: which one is chosen, why, and what is asked of it.
//!
//! A GPU comes first, then software Vulkan, then GL: a GPU draws in milliseconds, software Vulkan draws the same
//! picture slowly, and GL lacks filtering of 32-bit textures on many drivers.

/// The device that draws, and why it was chosen; clones share it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance it came from.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// The device's queue.
    pub queue: wgpu::Queue,
    /// The choice, in words.
    pub choice: AdapterChoice,
}

/// An adapter in words, for the status bar and the `adapters` command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterChoice {
    /// The adapter's own name.
    pub name: String,
    /// The interface it is driven through: `vulkan`, `metal`, `dx12` or `gl`.
    pub backend: &'static str,
    /// True where the processor does the drawing.
    pub software: bool,
    /// One sentence: what it is and what to expect of it.
    pub reason: String,
}

/// An adapter as the `adapters` command lists it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedAdapter {
    /// The adapter, in words.
    pub choice: AdapterChoice,
    /// Its place in the order of preference, 0 the most preferred kind.
    pub rank: u32,
    /// True for the one that would be used.
    pub used: bool,
}

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is neither a GPU nor a software renderer.
    #[error(
        "no graphics adapter was found, so nothing can be drawn: install a GPU driver or Mesa's software Vulkan \
         (Debian, Ubuntu: apt install mesa-vulkan-drivers); `fit` and `probe` work without one"
    )]
    NoAdapter,
    /// `WGPU_ADAPTER_NAME` names no adapter that is there.
    #[error("no graphics adapter has '{0}' in its name, as WGPU_ADAPTER_NAME asks; `adapters` lists those there are")]
    NoSuchAdapter(String),
    /// The adapter gave no device.
    #[error("the graphics adapter {name} gave no device: {source}")]
    NoDevice {
        /// The adapter's name.
        name: String,
        /// What the driver said.
        source: wgpu::RequestDeviceError,
    },
}

impl AdapterChoice {
    /// Describes an adapter.
    pub fn of(info: &wgpu::AdapterInfo) -> Self {
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let gl = info.backend == wgpu::Backend::Gl;
        let name = if info.name.is_empty() { "unnamed adapter" } else { &info.name };
        let reason = match (software, gl) {
            (false, false) => format!("{name} ({} GPU)", interface(info.backend)),
            (false, true) => format!("{name} (GL): neither a Vulkan GPU nor software Vulkan was found"),
            (true, false) => {
                format!("{name} (software {}): no GPU was found; drawing will be slow", interface(info.backend))
            }
            (true, true) => format!("{name} (software GL): no GPU and no Vulkan were found; drawing will be slow"),
        };
        Self { name: name.to_owned(), backend: info.backend.to_str(), software, reason }
    }
}

fn interface(backend: wgpu::Backend) -> &'static str {
    match backend {
        wgpu::Backend::Vulkan => "Vulkan",
        wgpu::Backend::Metal => "Metal",
        wgpu::Backend::Dx12 => "Direct3D 12",
        wgpu::Backend::Gl => "GL",
        wgpu::Backend::BrowserWebGpu => "WebGPU",
        wgpu::Backend::Noop => "dummy",
    }
}

/// The place of an adapter's kind in the order of preference, 0 first.
pub fn rank(info: &wgpu::AdapterInfo) -> u32 {
    use wgpu::DeviceType as Type;
    match (info.backend, info.device_type) {
        (wgpu::Backend::Noop, _) => 9,
        (wgpu::Backend::Gl, Type::Cpu) => 5,
        (wgpu::Backend::Gl, _) => 4,
        (_, Type::DiscreteGpu) => 0,
        (_, Type::IntegratedGpu) => 1,
        (_, Type::VirtualGpu | Type::Other) => 2,
        (_, Type::Cpu) => 3,
    }
}

/// The index of the adapter to use: the first of the best rank among those whose name holds `wanted`, in any case
/// of letters. `None` where none does.
pub fn choose(adapters: &[wgpu::AdapterInfo], wanted: Option<&str>) -> Option<usize> {
    let wanted = wanted.map(str::to_lowercase);
    let fits = |info: &wgpu::AdapterInfo| wanted.as_ref().is_none_or(|part| info.name.to_lowercase().contains(part));
    (0..adapters.len()).filter(|&i| fits(&adapters[i])).min_by_key(|&i| rank(&adapters[i]))
}

/// The adapter to use out of `adapters`, among those that can present to `surface` if there is one.
/// `WGPU_ADAPTER_NAME` overrides the order of preference.
pub fn select(adapters: &[wgpu::Adapter], surface: Option<&wgpu::Surface<'_>>) -> Result<wgpu::Adapter, GpuError> {
    let presenting: Vec<&wgpu::Adapter> =
        adapters.iter().filter(|adapter| surface.is_none_or(|s| adapter.is_surface_supported(s))).collect();
    let infos: Vec<_> = presenting.iter().map(|adapter| adapter.get_info()).collect();
    let wanted = wanted_name();
    match (choose(&infos, wanted.as_deref()), wanted) {
        (Some(index), _) => Ok(presenting[index].clone()),
        (None, Some(name)) if !infos.is_empty() => Err(GpuError::NoSuchAdapter(name)),
        (None, _) => Err(GpuError::NoAdapter),
    }
}

fn wanted_name() -> Option<String> {
    std::env::var("WGPU_ADAPTER_NAME").ok().filter(|name| !name.is_empty())
}

/// What is asked of an adapter: its own texture and buffer limits, so that an 8192 x 8192 map fits where it can, and
/// filtering of 32-bit textures and timestamps where they are offered.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let offered = adapter.limits();
    let limits = wgpu::Limits {
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        max_texture_array_layers: offered.max_texture_array_layers,
        max_buffer_size: offered.max_buffer_size,
        ..wgpu::Limits::default().or_worse_values_from(&offered)
    };
    wgpu::DeviceDescriptor {
        label: Some("inspector device"),
        required_features: adapter.features() & (wgpu::Features::FLOAT32_FILTERABLE | wgpu::Features::TIMESTAMP_QUERY),
        required_limits: limits,
        ..Default::default()
    }
}

/// An instance over `backends`, or those of them that `WGPU_BACKEND` names.
fn instance(backends: wgpu::Backends) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= backends;
    wgpu::Instance::new(descriptor)
}

fn enumerate(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
}

/// Every adapter, the most preferred first, and which one would be used.
pub fn list() -> Vec<ListedAdapter> {
    let infos: Vec<_> = enumerate(&instance(wgpu::Backends::all())).iter().map(wgpu::Adapter::get_info).collect();
    let used = choose(&infos, wanted_name().as_deref());
    let listed = |(index, info): (usize, &wgpu::AdapterInfo)| ListedAdapter {
        choice: AdapterChoice::of(info),
        rank: rank(info),
        used: used == Some(index),
    };
    let mut adapters: Vec<_> = infos.iter().enumerate().map(listed).collect();
    adapters.sort_by_key(|adapter| adapter.rank);
    adapters
}

impl Gpu {
    /// Opens the preferred adapter without a window. GL, last in rank, is started only where nothing else is found:
    /// its libraries write to the terminal on a machine without a display.
    pub fn headless() -> Result<Self, GpuError> {
        Self::over(wgpu::Backends::all() - wgpu::Backends::GL).or_else(|_| Self::over(wgpu::Backends::all()))
    }

    fn over(backends: wgpu::Backends) -> Result<Self, GpuError> {
        let instance = instance(backends);
        let adapter = select(&enumerate(&instance), None)?;
        let choice = AdapterChoice::of(&adapter.get_info());
        let (device, queue) = pollster::block_on(adapter.request_device(&device_descriptor(&adapter)))
            .map_err(|source| GpuError::NoDevice { name: choice.name.clone(), source })?;
        Ok(Self { instance, adapter, device, queue, choice })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(name: &str, backend: wgpu::Backend, device_type: wgpu::DeviceType) -> wgpu::AdapterInfo {
        wgpu::AdapterInfo { name: name.to_owned(), ..wgpu::AdapterInfo::new(device_type, backend) }
    }

    #[test]
    fn a_gpu_comes_before_software_vulkan_and_that_before_gl() {
        use wgpu::{Backend, DeviceType};
        let adapters = [
            info("llvmpipe", Backend::Gl, DeviceType::Cpu),
            info("Iris", Backend::Gl, DeviceType::IntegratedGpu),
            info("llvmpipe", Backend::Vulkan, DeviceType::Cpu),
            info("Iris", Backend::Vulkan, DeviceType::IntegratedGpu),
            info("GeForce", Backend::Dx12, DeviceType::DiscreteGpu),
        ];
        for count in 1..=adapters.len() {
            assert_eq!(choose(&adapters[..count], None), Some(count - 1));
        }
        assert_eq!(choose(&adapters, Some("iris")), Some(3), "a name overrides the order");
        assert_eq!(choose(&adapters, Some("Radeon")), None);
        assert_eq!(choose(&[], None), None);
    }

    #[test]
    fn software_rendering_says_so_and_a_gpu_does_not() {
        use wgpu::{Backend, DeviceType};
        let software = AdapterChoice::of(&info("llvmpipe", Backend::Vulkan, DeviceType::Cpu));
        assert!(software.software);
        assert_eq!(software.reason, "llvmpipe (software Vulkan): no GPU was found; drawing will be slow");
        let gpu = AdapterChoice::of(&info("Arc", Backend::Vulkan, DeviceType::DiscreteGpu));
        assert!(!gpu.software && !gpu.reason.contains("slow"));
    }

    #[test]
    fn no_adapter_names_what_to_install_and_what_still_works() {
        let sentence = GpuError::NoAdapter.to_string();
        assert!(sentence.contains("mesa-vulkan-drivers") && sentence.contains("`fit` and `probe`"));
    }
}
