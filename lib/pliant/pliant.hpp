#pragma once

// Everything that a program needs to load or build a scene, simulate it and write it.

#include "pliant/io/writer.hpp"
#include "pliant/replay/folder_store.hpp"
#include "pliant/replay/replay.hpp"
#include "pliant/replay/state_file.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/write.hpp"
#include "pliant/simulation/frame_store.hpp"
#include "pliant/simulation/preview.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/timeline/sampler.hpp"
