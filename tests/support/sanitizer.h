// Whether the tests run under AddressSanitizer or ThreadSanitizer, which take memory of their own for each byte.
#pragma once

namespace lightwell::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace lightwell::test
