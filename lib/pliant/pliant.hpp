#pragma once

// Everything that a program needs to load or build a scene, simulate it and write it.

#include "pliant/document/document.hpp"
#include "pliant/document/save_scene.hpp"
#include "pliant/feedback/contact_summary.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/feedback/suggestion.hpp"
#include "pliant/files/write_mesh.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/replay/replay.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/write.hpp"
#include "pliant/simulation/live.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/simulation/state_file.hpp"
#include "pliant/states/folder_store.hpp"
#include "pliant/states/state_store.hpp"
#include "pliant/sweep/sweep.hpp"
#include "pliant/timeline/sampler.hpp"
