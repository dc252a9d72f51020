/** The page's renderer: a graphics processor, or the processor, which the simulator may need itself. */

const SOFTWARE = /llvmpipe|softpipe|swiftshader|software/i;

/** Whether pictures are drawn by the processor. */
export const isSoftware = SOFTWARE.test(rendererName());

function rendererName(): string {
  const context = document.createElement("canvas").getContext("webgl2");
  if (context === null) return "";
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name = String(context.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}
