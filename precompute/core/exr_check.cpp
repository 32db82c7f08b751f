#include "precompute/core/exr_check.h"

#include <openexr.h>

#include <string>

#include "precompute/core/error.h"

namespace lightwell {

void checkExrHeaders(const std::filesystem::path& file) {
  std::string reason;
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  options.user_data = &reason;
  options.error_handler_fn = [](exr_const_context_t context, exr_result_t, const char* message) {
    void* user = nullptr;
    if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user && message && static_cast<std::string*>(user)->empty())
      *static_cast<std::string*>(user) = message;
  };
  exr_context_t context = nullptr;
  const exr_result_t result = exr_start_read(&context, file.c_str(), &options);
  if (context) exr_finish(&context);
  if (result != EXR_ERR_SUCCESS || !reason.empty()) throw InputError(file.string(), "header", reason.empty() ? exr_get_default_error_message(result) : reason);
}

}  // namespace lightwell
