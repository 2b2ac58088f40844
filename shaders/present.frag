#version 450
// A finished picture, scaled to the target.
layout(binding = 0) uniform sampler2D picture; // already display-encoded, bilinear
uniform vec2 targetSize;
layout(location = 0) out vec4 outColor;

void main() { outColor = vec4(texture(picture, gl_FragCoord.xy / targetSize).rgb, 1.0); }
