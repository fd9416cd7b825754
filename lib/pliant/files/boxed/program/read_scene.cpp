#include "pliant/files/boxed/program/read_scene.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <new>
#include <string_view>
#include <utility>

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>

#include "pliant/files/boxed/program/assimp_files.hpp"

namespace pliant {
namespace {

// Removes assimp's readers for other endings: it would try all of its forty on a file that the
// right ones refuse.
void keep_readers(Assimp::Importer& importer, const std::string& ending) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const std::string known = std::string(" ") + importer.GetImporterInfo(k)->mFileExtensions + " ";
    if (known.find(" " + ending + " ") != std::string::npos) continue;
    const std::unique_ptr<Assimp::BaseImporter> dropped(importer.GetImporter(k));
    importer.UnregisterLoader(dropped.get());
  }
}

// Skips data that a mesh does not need.
void set_properties(Assimp::Importer& importer) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);  // not the ids
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  for (const char* unread : {AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS,
                             AI_CONFIG_IMPORT_FBX_READ_WEIGHTS, AI_CONFIG_IMPORT_FBX_READ_CAMERAS,
                             AI_CONFIG_IMPORT_FBX_READ_LIGHTS, AI_CONFIG_IMPORT_FBX_READ_TEXTURES})
    importer.SetPropertyBool(unread, false);
}

bool contains(std::string_view text, std::string_view word) {
  return std::search(text.begin(), text.end(), word.begin(), word.end(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         }) != text.end();
}

// Nothing of a file in another format may be revealed, and assimp quotes text that it does not
// know.
bool is_of_format(std::string_view bytes, const std::string& ending) {
  if (ending == "fbx") return contains(bytes.substr(0, 1024), "fbx");
  if (ending == "dae") return contains(bytes.substr(0, 65536), "<collada");
  return true;
}

}  // namespace

AssimpScene read_scene(std::string bytes, const std::string& ending) {
  AssimpScene result;
  result.is_other_format = !is_of_format(bytes, ending);
  if (result.is_other_format) return result;
  const std::string name = "mesh." + ending;
  result.importer = std::make_unique<Assimp::Importer>();
  keep_readers(*result.importer, ending);
  set_properties(*result.importer);
  result.importer->SetIOHandler(new AssimpFiles(name, std::move(bytes)));  // takes ownership
  result.scene = result.importer->ReadFile(name, 0);
  if (result.scene && result.scene->mRootNode) return result;
  result.scene = nullptr;
  if (result.importer->GetException()) {
    try {
      std::rethrow_exception(result.importer->GetException());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {  // its message is the error string
    }
  }
  result.reason = result.importer->GetErrorString();
  return result;
}

}  // namespace pliant
