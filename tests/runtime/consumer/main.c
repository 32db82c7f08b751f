#include <lightwell/lightwell.h>
#include <lightwell/lightwell_gl.h>
#include <stdio.h>

int main(void) {
  lw_container *container = NULL;
  if (lw_version() != LW_VERSION || lw_open_file("/nonexistent.lwc", NULL, &container) != LW_IO_ERROR || !lw_glsl_source(LW_GLSL_ATLAS)) return 1;
  printf("lightwell %s\n", LW_VERSION_STRING);
  return 0;
}
