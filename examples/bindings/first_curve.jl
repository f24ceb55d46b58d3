# first_curve.jl - the tip of a rotor blade over time, by the shared library. From the top: julia examples/bindings/first_curve.jl
const scene = "build/bindings/libflexbeam_scene"
const OUTPUTS = 2 # FBS_OUTPUTS
rotor = @ccall scene.fbs_new()::Ptr{Cvoid}
well(status) = status == 0 || error(unsafe_string(@ccall scene.fbs_error(rotor::Ptr{Cvoid})::Ptr{UInt8}))
well(@ccall scene.fbs_open(rotor::Ptr{Cvoid}, "examples/scenes/rotor.txt"::Cstring, C_NULL::Ptr{Cvoid}, 0::Cint, C_NULL::Ptr{Cvoid}, C_NULL::Ptr{Cvoid})::Cint)
tip, z = (@ccall scene.fbs_find(rotor::Ptr{Cvoid}, OUTPUTS::Cint, "tip_1"::Cstring)::Cint), Ref(0.0)
for k in 0:5
    well(@ccall scene.fbs_step_to(rotor::Ptr{Cvoid}, (0.5 * k)::Cdouble)::Cint)
    well(@ccall scene.fbs_get(rotor::Ptr{Cvoid}, OUTPUTS::Cint, 1::Cint, Ref(tip)::Ref{Cint}, z::Ref{Cdouble})::Cint)
    println(0.5 * k, " s: ", z[], " m")
end
@ccall scene.fbs_free(rotor::Ptr{Cvoid})::Cvoid
