//! What training computes on: the devices of Burn that this build has.

use std::fmt;
use std::str::FromStr;

use burn::tensor::Device;
use thiserror::Error;

/// What training computes on, by name: `flex`, `ndarray`, `wgpu`, `cuda`, `cuda:1`, `rocm`, `remote:ws://host:3000`.
///
/// All but the first are there when the crate is built with the feature of the same name.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum ComputeDevice {
    /// Burn's own kernels on the processor: the default, and what the shipped models were trained on.
    #[default]
    Flex,
    /// The processor by way of `ndarray`.
    NdArray,
    /// The graphics card that wgpu prefers: Vulkan, Metal, DirectX.
    Wgpu,
    /// An NVIDIA card, by number.
    Cuda(usize),
    /// An AMD card, by number.
    Rocm(usize),
    /// Another machine on which Burn's server runs: its WebSocket address.
    Remote(String),
}

/// Why there is no such device.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceError {
    /// No device is called so.
    #[error(
        "no device is called \"{0}\": flex, ndarray, wgpu, cuda (or cuda:1), rocm (or rocm:1), remote:ws://HOST:PORT"
    )]
    Unknown(String),
    /// It was not built in.
    #[error("this build cannot compute on {device}; build it with `--features {feature}`")]
    NotBuilt {
        /// The device.
        device: ComputeDevice,
        /// The crate's feature that brings it.
        feature: &'static str,
    },
    /// The other machine does not answer.
    #[error("{device} does not answer: {problem}")]
    Unreachable {
        /// The device.
        device: ComputeDevice,
        /// What went wrong.
        problem: String,
    },
}

impl ComputeDevice {
    /// The device for tensors whose gradients are asked for.
    ///
    /// # Errors
    /// [`DeviceError::NotBuilt`] without its feature, [`DeviceError::Unreachable`] where nobody listens.
    pub(crate) fn open(&self) -> Result<Device, DeviceError> {
        Ok(self.plain()?.autodiff())
    }

    /// The device for tensors without gradients.
    fn plain(&self) -> Result<Device, DeviceError> {
        // What was built in is taken; what is left was not.
        match self {
            Self::Flex => Ok(Device::flex()),
            #[cfg(feature = "ndarray")]
            #[expect(deprecated, reason = "a second opinion for as long as Burn has it")]
            Self::NdArray => Ok(Device::ndarray()),
            #[cfg(feature = "wgpu")]
            Self::Wgpu => Ok(Device::wgpu(burn::tensor::DeviceKind::DefaultDevice)),
            #[cfg(feature = "cuda")]
            Self::Cuda(index) => Ok(Device::cuda(*index)),
            #[cfg(feature = "rocm")]
            Self::Rocm(index) => Ok(Device::rocm(*index)),
            #[cfg(feature = "remote")]
            Self::Remote(address) => self.connected(address),
            #[allow(
                unreachable_patterns,
                reason = "reached but in a build with all features"
            )]
            _ => Err(DeviceError::NotBuilt {
                device: self.clone(),
                feature: self.feature(),
            }),
        }
    }

    #[cfg(feature = "remote")]
    fn connected(&self, address: &str) -> Result<Device, DeviceError> {
        let host = burn::tensor::remote::RemoteHost::websocket(address);
        let device = Device::remote_options(&host).init();
        device.map_err(|problem| DeviceError::Unreachable {
            device: self.clone(),
            problem: problem.to_string(),
        })
    }

    /// The crate's feature that brings it; its name, too.
    fn feature(&self) -> &'static str {
        match self {
            Self::Flex => "flex",
            Self::NdArray => "ndarray",
            Self::Wgpu => "wgpu",
            Self::Cuda(_) => "cuda",
            Self::Rocm(_) => "rocm",
            Self::Remote(_) => "remote",
        }
    }
}

impl fmt::Display for ComputeDevice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.feature())?;
        match self {
            Self::Cuda(index) | Self::Rocm(index) => write!(f, ":{index}"),
            Self::Remote(address) => write!(f, ":{address}"),
            Self::Flex | Self::NdArray | Self::Wgpu => Ok(()),
        }
    }
}

impl FromStr for ComputeDevice {
    type Err = DeviceError;

    fn from_str(name: &str) -> Result<Self, DeviceError> {
        let unknown = || DeviceError::Unknown(name.to_owned());
        let (kind, which) = name
            .split_once(':')
            .map_or((name, None), |(kind, which)| (kind, Some(which)));
        let index = || which.map_or(Ok(0), |which| which.parse().map_err(|_| unknown()));
        match (kind, which) {
            ("flex", None) => Ok(Self::Flex),
            ("ndarray", None) => Ok(Self::NdArray),
            ("wgpu", None) => Ok(Self::Wgpu),
            ("cuda", _) => Ok(Self::Cuda(index()?)),
            ("rocm", _) => Ok(Self::Rocm(index()?)),
            ("remote", Some(address)) if !address.is_empty() => {
                Ok(Self::Remote(address.to_owned()))
            }
            _ => Err(unknown()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for name in [
            "flex",
            "ndarray",
            "wgpu",
            "cuda:0",
            "cuda:3",
            "rocm:1",
            "remote:ws://gpu:3000",
        ] {
            let device: ComputeDevice = name.parse().unwrap();
            assert_eq!(device.to_string(), name);
        }
        assert_eq!("cuda".parse(), Ok(ComputeDevice::Cuda(0)));
        for wrong in ["", "gpu", "cuda:first", "flex:1", "remote", "remote:"] {
            let found = wrong.parse::<ComputeDevice>();
            assert_eq!(found, Err(DeviceError::Unknown(wrong.to_owned())));
        }
    }

    #[test]
    #[cfg(not(feature = "rocm"))]
    fn what_is_not_built_in_is_told_with_its_feature() {
        let error = ComputeDevice::Rocm(0).open().map(|_| ()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "this build cannot compute on rocm:0; build it with `--features rocm`"
        );
    }
}
