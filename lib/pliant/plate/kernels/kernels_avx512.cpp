#include "pliant/plate/kernels/kernels.hpp"

#define PLIANT_LANES 8
#define PLIANT_KERNELS avx512
#define PLIANT_KERNELS_NAME "avx512"
#include "pliant/plate/kernels/sine_transform_lanes.hpp"
#include "pliant/plate/kernels/spectral_fields_lanes.hpp"
#include "pliant/plate/kernels/spectral_steps_lanes.hpp"
#include "pliant/plate/kernels/step_exactly_lanes.hpp"
#include "pliant/plate/kernels/step_plastic_lanes.hpp"
#include "pliant/plate/kernels/supernode_lanes.hpp"
#include "pliant/plate/kernels/table_lanes.hpp"
