//! How the list of machines becomes two enums: geometry as configured, and kinematics as built.

/// Name in the machine file, variant, configuration, and the [`Chain`](super::Chain) that is built of it.
macro_rules! machines {
    ($($(#[$doc:meta])* $key:literal $name:ident: $config:ty => $chain:ty,)+) => {
        /// Geometry of a machine, as it stands in the machine file.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
        #[expect(clippy::large_enum_variant, reason = "boards do not allocate; a machine has one")]
        pub enum KinematicsConfig {
            $($(#[$doc])* #[serde(rename = $key)] $name($config),)+
        }

        impl KinematicsConfig {
            /// Names of all machines.
            pub const NAMES: &[&str] = &[$($key),+];

            /// Name of this one.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => $key,)+
                }
            }

            /// Axis of its joint of this number, from the work to the tool.
            pub fn joint(&self, number: usize) -> Option<usize> {
                match self {
                    $(Self::$name(config) => config.joint(number),)+
                }
            }

            /// Which of X Y Z A B C the machine has.
            pub fn fitted(&self) -> [bool; AXES] {
                let mut fitted = [false; AXES];
                for axis in (0..AXES).filter_map(|number| self.joint(number)) {
                    fitted[axis] = true;
                }
                fitted
            }

            /// Checks the geometry; `limits` are those of the axes, for machines whose branch depends on them.
            #[cold]
            pub fn build(&self, limits: &[AxisLimits; AXES]) -> Result<Kinematics, ParameterError> {
                Ok(match self {
                    $(Self::$name(config) => Kinematics::$name(config.build(limits)?),)+
                })
            }
        }

        /// Kinematics of a machine, ready for the tick.
        #[derive(Clone, Debug, PartialEq)]
        #[expect(clippy::large_enum_variant, reason = "boards do not allocate; a machine has one")]
        pub enum Kinematics {
            $($(#[$doc])* $name($chain),)+
        }

        impl Kinematics {
            /// See [`Chain::forward`].
            pub fn forward(&self, axes: &[f64; AXES]) -> Pose {
                match self {
                    $(Self::$name(chain) => chain.forward(axes),)+
                }
            }

            /// See [`Chain::inverse`].
            pub fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
                match self {
                    $(Self::$name(chain) => chain.inverse(pose, near),)+
                }
            }

            /// See [`Chain::derivatives`].
            pub fn derivatives(
                &self,
                axes: &[f64; AXES],
                motion: &PoseMotion,
            ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
                match self {
                    $(Self::$name(chain) => chain.derivatives(axes, motion),)+
                }
            }

            /// See [`Chain::inverse_motion`].
            pub fn inverse_motion(
                &self,
                pose: &Pose,
                motion: &PoseMotion,
                near: &[f64; AXES],
            ) -> Result<AxisMotion, KinematicsError> {
                match self {
                    $(Self::$name(chain) => chain.inverse_motion(pose, motion, near),)+
                }
            }

            /// See [`Chain::rates`].
            pub fn rates(
                &self,
                axes: &[f64; AXES],
                v: &Vector3<f64>,
                omega: &Vector3<f64>,
            ) -> Result<[f64; AXES], KinematicsError> {
                match self {
                    $(Self::$name(chain) => chain.rates(axes, v, omega),)+
                }
            }
        }
    };
}
