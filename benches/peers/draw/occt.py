"""OCCT's hidden-line removal as a peer of `vitral draw`. Usage: drawing.py tells.

Tasks: `exact` is HLRBRep_Algo, `polygons` HLRBRep_PolyAlgo. Every triangle is a planar face, so all of its edges are
drawn. OCCT writes no SVG file here: its edges, which are straight, go through `write_svg`.
"""

import numpy as np
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape, HLRBRep_PolyAlgo, HLRBRep_PolyHLRToShape
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shell, TopoDS_Vertex

from drawing import BACK, RIGHT, Watch, arguments, read_mesh, write_svg


def shell(positions, triangles):
    """A shell of planar faces that share their edges and vertices."""
    builder, faces = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(faces)
    points = [gp_Pnt(*position) for position in positions.tolist()]
    vertices = [TopoDS_Vertex() for _ in points]
    for vertex, point in zip(vertices, points):
        builder.MakeVertex(vertex, point, 1e-7)
    edges = {}

    def edge(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in edges:
            edges[key] = BRepBuilderAPI_MakeEdge(vertices[key[0]], vertices[key[1]]).Edge()
        found = edges[key]
        return found if a < b else TopoDS.Edge(found.Reversed())

    sides = positions[triangles]
    normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    for (a, b, c), normal in zip(triangles.tolist(), normals.tolist()):
        if normal == [0.0, 0.0, 0.0] or len({a, b, c}) < 3:
            continue
        wire = BRepBuilderAPI_MakeWire(edge(a, b), edge(b, c), edge(c, a)).Wire()
        builder.Add(faces, BRepBuilderAPI_MakeFace(gp_Pln(points[a], gp_Dir(*normal)), wire).Face())
    return faces


def visible(faces, task):
    """Compounds of visible edges in the plane of the drawing."""
    projector = HLRAlgo_Projector(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(*BACK), gp_Dir(*RIGHT)))
    if task == "polygons":
        BRepMesh_IncrementalMesh(faces, 1.0)
        algorithm = HLRBRep_PolyAlgo()
        algorithm.Load(faces)
        algorithm.Projector(projector)
        algorithm.Update()
        found = HLRBRep_PolyHLRToShape()
        found.Update(algorithm)
    else:
        algorithm = HLRBRep_Algo()
        algorithm.Add(faces)
        algorithm.Projector(projector)
        algorithm.Update()
        algorithm.Hide()
        found = HLRBRep_HLRToShape(algorithm)
    kinds = [found.VCompound(), found.Rg1LineVCompound(), found.RgNLineVCompound(), found.OutLineVCompound()]
    return [kind for kind in kinds if kind is not None and not kind.IsNull()]


def segments(compounds):
    """Both ends of each edge."""
    lines = []
    for compound in compounds:
        explorer = TopExp_Explorer(compound, TopAbs_EDGE)
        while explorer.More():
            edge = TopoDS.Edge(explorer.Current())
            ends = [BRep_Tool.Pnt_s(find(edge)) for find in (TopExp.FirstVertex_s, TopExp.LastVertex_s)]
            lines.append(np.array([[end.X(), end.Y()] for end in ends]))
            explorer.Next()
    return lines


def main():
    path, out, task, _ = arguments()
    watch = Watch()
    faces = shell(*read_mesh(path))
    watch.end("load")
    lines = segments(visible(faces, task))
    watch.end("draw")
    write_svg(out, lines)
    watch.end("write")
    watch.report("8.0", len(lines))


main()
