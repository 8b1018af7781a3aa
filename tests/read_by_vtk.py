"""Fields of recordings as VTK's own reader finds them."""

import numpy as np


def point_fields(path):
    """Of each step of a recording, the fields at its points by name, with the points as "points"."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0)
    for i in range(reader.GetNumberOfSteps()):
        reader.UpdateTimeStep(times.Get(Pipeline.TIME_STEPS(), i))
        grid = reader.GetOutputDataObject(0)
        data = grid.GetPointData()
        arrays = [data.GetArray(k) for k in range(data.GetNumberOfArrays())]
        found = {array.GetName(): np.array(vtk_to_numpy(array)) for array in arrays}
        yield {**found, "points": np.array(vtk_to_numpy(grid.GetPoints().GetData()))}
