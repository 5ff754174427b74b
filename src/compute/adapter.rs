//! Which adapters there are, and what they can do.

use serde::Serialize;

/// A device that could compute.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Adapter {
    /// What it is called by.
    pub name: String,
    /// What it is.
    pub kind: AdapterKind,
    /// Its driver, with version.
    pub driver: String,
    /// How much it takes at once.
    pub limits: AdapterLimits,
    /// What it can beyond the usual, of what matters here.
    pub features: Vec<&'static str>,
}

/// What kind of device, the fastest last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AdapterKind {
    /// The processor, made to look like one.
    Software,
    /// Not told.
    Other,
    /// One that a virtual machine lends.
    Virtual,
    /// A part of the processor.
    Integrated,
    /// A card.
    Discrete,
}

/// How much a device takes at once.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct AdapterLimits {
    /// Bytes of a buffer a kernel can see.
    pub binding_bytes: u64,
    /// Bytes of any buffer.
    pub buffer_bytes: u64,
    /// Threads of a workgroup.
    pub workgroup_threads: u32,
    /// Bytes a workgroup shares.
    pub workgroup_bytes: u32,
    /// Workgroups of one dispatch.
    pub workgroups: u32,
}

/// The adapters of this machine, the fastest kind first.
pub fn adapters() -> Vec<Adapter> {
    present().iter().map(Adapter::of).collect()
}

/// The same as wgpu knows them.
pub(super) fn present() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut present = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    // A stable sort: of one kind the driver's own order counts.
    present.sort_by_key(|adapter| std::cmp::Reverse(kind(adapter)));
    present
}

/// Features worth telling.
const TOLD: [(wgpu::Features, &str); 6] = [
    (wgpu::Features::SHADER_F64, "f64"),
    (wgpu::Features::SHADER_F16, "f16"),
    (wgpu::Features::SHADER_INT64, "int64"),
    (wgpu::Features::SUBGROUP, "subgroups"),
    (wgpu::Features::TIMESTAMP_QUERY, "timestamps"),
    (wgpu::Features::PIPELINE_CACHE, "pipeline-cache"),
];

impl Adapter {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let driver = format!("{} {}", info.driver, info.driver_info);
        let features = adapter.features();
        Self {
            name: info.name,
            kind: kind(adapter),
            driver: driver.trim().to_owned(),
            limits: AdapterLimits {
                binding_bytes: limits.max_storage_buffer_binding_size,
                buffer_bytes: limits.max_buffer_size,
                workgroup_threads: limits.max_compute_invocations_per_workgroup,
                workgroup_bytes: limits.max_compute_workgroup_storage_size,
                workgroups: limits.max_compute_workgroups_per_dimension,
            },
            features: TOLD
                .iter()
                .filter(|(feature, _)| features.contains(*feature))
                .map(|(_, name)| *name)
                .collect(),
        }
    }
}

fn kind(adapter: &wgpu::Adapter) -> AdapterKind {
    match adapter.get_info().device_type {
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        wgpu::DeviceType::Other => AdapterKind::Other,
        wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
        wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
    }
}

impl AdapterKind {
    /// In words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Software => "software",
            Self::Other => "other",
            Self::Virtual => "virtual",
            Self::Integrated => "integrated",
            Self::Discrete => "discrete",
        }
    }
}
