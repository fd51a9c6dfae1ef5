#include "core/loaded_object.h"

#include <dlfcn.h>

#include <filesystem>

namespace seamwright {

Expected<void*> loaded_symbol(const char* object, const char* name) {
    std::error_code none;
    const auto beside = std::filesystem::read_symlink("/proc/self/exe", none).parent_path() / object;
    void* const opened = dlopen(beside.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const symbol = opened ? dlsym(opened, name) : nullptr;
    if (symbol) return symbol;
    const char* said = dlerror();
    return file_error("a part of this installation is missing", said ? said : beside.string(),
                      Text("put {} beside the program", object));
}

}  // namespace seamwright
