#include "pliant/plate/spectral/spectral_kernels.hpp"

#define PLIANT_LANES 2
#define PLIANT_KERNELS baseline
#define PLIANT_KERNELS_NAME "baseline"
#include "pliant/plate/spectral/sine_transform_lanes.hpp"
#include "pliant/plate/spectral/spectral_fields_lanes.hpp"
#include "pliant/plate/spectral/spectral_kernels_lanes.hpp"
