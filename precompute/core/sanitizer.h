// Whether this is built with AddressSanitizer or ThreadSanitizer, which take memory of their own for each byte.
#pragma once

namespace lightwell {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace lightwell
